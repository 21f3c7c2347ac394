/// @file image_material.cpp
/// Searches the owner of every voxel, and the material of its value.
#include "host/reference/simulate/image_material.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/pixel_dispatch.hpp"

namespace tetwarp::reference {
namespace {

__extension__ using Wide = __int128;
using Lattice3 = std::array<std::int64_t, 3>;
constexpr double quanta_per_voxel = 1048576;

/// Six times the signed volume of four points.
Wide volume_of(const std::array<Lattice3, 4>& p) {
  std::array<std::array<Wide, 3>, 3> e;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) e[row][axis] = p[row + 1][axis] - p[0][axis];
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
         e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

bool contains(const std::array<Lattice3, 4>& tet, const Lattice3& x) {
  const Wide whole = volume_of(tet);
  if (whole == 0) return false;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    auto part = tet;
    part[corner] = x;
    const Wide volume = volume_of(part);
    if (volume != 0 && (volume > 0) != (whole > 0)) return false;
  }
  return true;
}

Matrix3d world_from_index(const Grid& grid) {
  Matrix3d m;
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) {
      m(row, axis) = grid.direction[static_cast<std::size_t>(3 * row + axis)] *
                     grid.spacing[static_cast<std::size_t>(axis)];
    }
  }
  return m;
}

double sample_at(const Volume& volume, const Lattice3& ijk) {
  const auto& dims = volume.grid.dims;
  const std::int64_t voxel = ijk[0] + dims[0] * (ijk[1] + dims[1] * ijk[2]);
  double value = 0;
  with_pixel_type(volume.type, [&](auto zero) {
    using T = decltype(zero);
    value = static_cast<double>(
        volume.samples<T>()[static_cast<std::size_t>(voxel * volume.components)]);
  });
  return value;
}

Lattice3 rounded(const Vector3d& v) {
  Lattice3 result;
  for (int axis = 0; axis < 3; ++axis) {
    result[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::nearbyint(v(axis)));
  }
  return result;
}

}  // namespace

std::vector<std::vector<OwnedVoxel>> owned_voxels(
    const ImageGeometry& image,
    const std::vector<Point3>& nodes,
    const std::vector<std::array<std::int32_t, 4>>& tets) {
  const Grid& grid = image.volume.grid;
  const Matrix3d to_world = world_from_index(grid);
  const Matrix3d from_world = to_world.inverse();
  const Vector3d origin = vector_of(grid.origin);
  std::vector<bool> is_owned(static_cast<std::size_t>(grid.voxel_count()));
  std::vector<std::vector<OwnedVoxel>> owned(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    std::array<Lattice3, 4> corners;
    Lattice3 first = grid.dims, last{-1, -1, -1};
    for (std::size_t a = 0; a < 4; ++a) {
      const Vector3d node = vector_of(nodes[static_cast<std::size_t>(tets[t][a])]);
      const Vector3d index = from_world * (node - origin);
      corners[a] = rounded(index * quanta_per_voxel);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double place = index(static_cast<Eigen::Index>(axis));
        const auto below = static_cast<std::int64_t>(std::floor(place)) - 1;
        first[axis] = std::min(first[axis], std::max(below, std::int64_t{0}));
        last[axis] = std::max(last[axis], std::min(below + 3, grid.dims[axis] - 1));
      }
    }
    Lattice3 ijk;
    for (ijk[2] = first[2]; ijk[2] <= last[2]; ++ijk[2]) {
      for (ijk[1] = first[1]; ijk[1] <= last[1]; ++ijk[1]) {
        for (ijk[0] = first[0]; ijk[0] <= last[0]; ++ijk[0]) {
          const auto voxel =
              static_cast<std::size_t>(ijk[0] + grid.dims[0] * (ijk[1] + grid.dims[1] * ijk[2]));
          if (is_owned[voxel]) continue;
          const Lattice3 centre{ijk[0] << 20, ijk[1] << 20, ijk[2] << 20};
          if (!contains(corners, centre)) continue;
          is_owned[voxel] = true;
          const double value = sample_at(image.volume, ijk);
          if (!(value >= image.threshold)) continue;
          const Vector3d index(static_cast<double>(ijk[0]), static_cast<double>(ijk[1]),
                               static_cast<double>(ijk[2]));
          owned[t].push_back({origin + to_world * index, value});
        }
      }
    }
  }
  return owned;
}

double value_at(const Volume& volume, const Vector3d& point) {
  const Grid& grid = volume.grid;
  Lattice3 ijk = rounded(world_from_index(grid).inverse() * (point - vector_of(grid.origin)));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ijk[axis] = std::clamp(ijk[axis], std::int64_t{0}, grid.dims[axis] - 1);
  }
  return sample_at(volume, ijk);
}

std::optional<Material> material_at(const Body& body, double value) {
  if (body.transfer.empty()) return body.material;
  const auto& table = body.transfer;
  if (body.lookup == TransferLookup::label) {
    for (const TransferPoint& entry : table) {
      if (entry.value == value) return entry.material;
    }
    return std::nullopt;
  }
  if (value <= table.front().value) return table.front().material;
  if (value >= table.back().value) return table.back().material;
  std::size_t next = 1;
  while (table[next].value < value) ++next;
  const TransferPoint &a = table[next - 1], &b = table[next];
  const double u = (value - a.value) / (b.value - a.value);
  const auto between = [u](double from, double to) { return from + u * (to - from); };
  return Material{between(a.material.youngs_modulus, b.material.youngs_modulus),
                  between(a.material.poissons_ratio, b.material.poissons_ratio),
                  between(a.material.density, b.material.density)};
}

}  // namespace tetwarp::reference
