/// @file exact_geometry.hpp
/// Geometry of the reference: rounded nodes, signed volumes in exact integers, barycentric
/// coordinates. Straight from the definitions, independent of kernels/.
#pragma once
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <tetwarp/volume.hpp>

namespace tetwarp::reference {

__extension__ using Integer = __int128;
using Quanta = std::array<std::int64_t, 3>;
using Corners = std::array<Quanta, 4>;

constexpr double one_voxel = 1048576.0;  // 2^20 quanta
constexpr std::int64_t one_voxel_int = 1048576;
constexpr double rim = 2.0 / one_voxel;  // tolerance at the source's boundary, for rounded nodes

/// Index-space matrix and its inverse of a grid.
struct IndexSpace {
  Eigen::Matrix3d to_world;
  Eigen::Matrix3d from_world;
  Eigen::Vector3d origin;

  explicit IndexSpace(const Grid& grid) {
    for (int row = 0; row < 3; ++row) {
      for (int axis = 0; axis < 3; ++axis) {
        to_world(row, axis) = grid.direction[static_cast<std::size_t>(3 * row + axis)] *
                              grid.spacing[static_cast<std::size_t>(axis)];
      }
      origin(row) = grid.origin[static_cast<std::size_t>(row)];
    }
    from_world = to_world.partialPivLu().inverse();
  }

  /// Nearest multiple of 2^-20 voxel: ((W0 dx + W1 dy) + W2 dz) per row; nothing beyond 2^40
  /// voxels.
  std::optional<Quanta> quanta_if_near(const double* world) const {
    Quanta q;
    for (int row = 0; row < 3; ++row) {
      double index = from_world(row, 0) * (world[0] - origin(0));
      index += from_world(row, 1) * (world[1] - origin(1));
      index += from_world(row, 2) * (world[2] - origin(2));
      if (!(std::abs(index) <= 0x1p40)) return std::nullopt;
      q[static_cast<std::size_t>(row)] =
          static_cast<std::int64_t>(std::nearbyint(index * one_voxel));
    }
    return q;
  }

  /// The same. @throws std::invalid_argument beyond 2^40 voxels
  Quanta quanta_of(const double* world) const {
    const std::optional<Quanta> q = quanta_if_near(world);
    if (!q) throw std::invalid_argument("a node is over 2^40 voxels from the grid");
    return *q;
  }
};

/// Six times the signed volume of (a, b, c, d).
inline Integer signed_volume(const Quanta& a, const Quanta& b, const Quanta& c, const Quanta& d) {
  Integer u[3], v[3], w[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    u[axis] = b[axis] - a[axis];
    v[axis] = c[axis] - a[axis];
    w[axis] = d[axis] - a[axis];
  }
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

inline Integer signed_volume(const Corners& tet) {
  return signed_volume(tet[0], tet[1], tet[2], tet[3]);
}

/// Determinants of nodes farther apart could exceed 128 bits.
/// @throws std::invalid_argument when nodes are more than 2^20 voxels apart
inline void check_extent(const Corners& tet) {
  for (const Quanta& a : tet) {
    for (const Quanta& b : tet) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (a[axis] - b[axis] > one_voxel_int * one_voxel_int) {
          throw std::invalid_argument("a tetrahedron spans over 2^20 voxels; use a coarser grid");
        }
      }
    }
  }
}

/// Barycentric coordinates of a point, and whether one of them is zero.
struct Barycentric {
  Eigen::Vector4d weight;
  bool on_face;
};

/// Those of x, or nothing when x is outside the closed tetrahedron.
inline std::optional<Barycentric> barycentric_of(const Corners& tet, const Quanta& x) {
  const Integer whole = signed_volume(tet);
  Barycentric result{Eigen::Vector4d::Zero(), false};
  for (std::size_t node = 0; node < 4; ++node) {
    Corners part = tet;
    part[node] = x;
    const Integer volume = signed_volume(part);
    if ((whole > 0 && volume < 0) || (whole < 0 && volume > 0)) return std::nullopt;
    result.on_face = result.on_face || volume == 0;
    result.weight(static_cast<Eigen::Index>(node)) =
        static_cast<double>(volume) / static_cast<double>(whole);
  }
  return result;
}

/// The whole-voxel shift from deformed to rest nodes, or nothing when a node deviates from it by
/// more than a quantum.
template <std::size_t node_count>
std::optional<Eigen::Vector3d> whole_shift(const std::array<Quanta, node_count>& rest,
                                           const std::array<Quanta, node_count>& deformed) {
  Eigen::Vector3d shift;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double first = static_cast<double>(rest[0][axis] - deformed[0][axis]) / one_voxel;
    const double whole = std::floor(first + 0.5);
    for (std::size_t node = 0; node < node_count; ++node) {
      const std::int64_t moved = rest[node][axis] - deformed[node][axis];
      if (std::abs(moved - static_cast<std::int64_t>(whole) * one_voxel_int) > 1) {
        return std::nullopt;
      }
    }
    shift(static_cast<Eigen::Index>(axis)) = whole;
  }
  return shift;
}

}  // namespace tetwarp::reference
