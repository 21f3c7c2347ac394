/// @file hex_split.cpp
/// Six tetrahedra of a hexahedron: two for each face without its lowest corner.
#include "host/warp/hex_split.hpp"

#include <algorithm>

namespace tetwarp {
namespace {
/// Corners around each face, seen from outside.
constexpr std::size_t faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
}  // namespace

std::vector<std::array<std::int32_t, 4>> split_hexes(
    std::span<const std::array<std::int32_t, 8>> hexes) {
  std::vector<std::array<std::int32_t, 4>> tets;
  tets.reserve(tets_per_hex * hexes.size());
  for (const auto& hex : hexes) {
    const auto apex =
        static_cast<std::size_t>(std::min_element(hex.begin(), hex.end()) - hex.begin());
    for (const auto& face : faces) {
      if (std::find(face, face + 4, apex) != face + 4) continue;
      const auto is_lower = [&](std::size_t a, std::size_t b) { return hex[a] < hex[b]; };
      const auto first = std::min_element(face, face + 4, is_lower) - face;
      const auto corner = [&](std::ptrdiff_t turn) { return hex[face[(first + turn) % 4]]; };
      tets.push_back({hex[apex], corner(0), corner(1), corner(2)});
      tets.push_back({hex[apex], corner(0), corner(2), corner(3)});
    }
  }
  return tets;
}

Mesh with_split_hexes(Mesh mesh) {
  const auto parts = split_hexes(mesh.hexes);
  mesh.tets.insert(mesh.tets.end(), parts.begin(), parts.end());
  return mesh;
}

}  // namespace tetwarp
