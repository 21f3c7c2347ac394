/// @file face_neighbors.cpp
/// Sorts faces by their nodes.
#include "host/warp/cpu/face_neighbors.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace tetwarp {
namespace {
struct Face {
  std::array<std::int32_t, 3> nodes;  ///< in ascending order
  std::int32_t tet;
  std::int8_t number;
  std::int8_t side;  ///< of the tetrahedron at rest, by the ascending order; 0: flat
};

Face face_of(const std::int32_t* nodes, std::int64_t tet, int number, double volume) {
  Face face{{nodes[(number + 1) % 4], nodes[(number + 2) % 4], nodes[(number + 3) % 4]},
            static_cast<std::int32_t>(tet),
            static_cast<std::int8_t>(number),
            static_cast<std::int8_t>((volume > 0) - (volume < 0))};
  bool is_odd = number % 2 != 0;  // a rotation of four numbers is an odd permutation
  for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {0, 1}}) {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    if (face.nodes[i] <= face.nodes[j]) continue;
    std::swap(face.nodes[i], face.nodes[j]);
    is_odd = !is_odd;
  }
  if (is_odd) face.side = static_cast<std::int8_t>(-face.side);
  return face;
}
}  // namespace

std::vector<std::int32_t> face_neighbors(View<const std::int32_t> tets,
                                         std::span<const double> rest_volumes) {
  std::vector<Face> faces;
  faces.reserve(static_cast<std::size_t>(tets.size));
  for (std::int64_t t = 0; t < tets.size / 4; ++t) {
    const double volume = rest_volumes[static_cast<std::size_t>(t)];
    for (int f = 0; f < 4; ++f) faces.push_back(face_of(tets.data + 4 * t, t, f, volume));
  }
  std::ranges::sort(faces, {}, &Face::nodes);
  std::vector<std::int32_t> neighbors(faces.size(), -1);
  for (std::size_t first = 0, past; first < faces.size(); first = past) {
    past = first + 1;
    while (past < faces.size() && faces[past].nodes == faces[first].nodes) ++past;
    const Face &one = faces[first], &other = faces[past - 1];
    if (past != first + 2 || one.side * other.side != -1) continue;
    neighbors[static_cast<std::size_t>(4 * std::int64_t{one.tet} + one.number)] = other.tet;
    neighbors[static_cast<std::size_t>(4 * std::int64_t{other.tet} + other.number)] = one.tet;
  }
  return neighbors;
}

}  // namespace tetwarp
