/// @file hex_scenes.hpp
/// Meshes of hexahedra for tests.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include <tetwarp/mesh.hpp>

#include "kernels/warp/hex_map.hpp"

namespace tetwarp::test {

using Mapping = std::function<Point3(const Point3&)>;

/// A box of cells[0] x cells[1] x cells[2] hexahedra, or with `parts` > 1 each of them cut into
/// parts^3, whose nodes lie where the trilinear map of the whole has them.
struct HexBox {
  Mesh mesh;
  std::vector<Point3> deformed;
};

inline HexBox hex_box(const std::array<int, 3>& cells,
                      const Point3& low,
                      const Point3& high,
                      const Mapping& deform,
                      int parts = 1) {
  const std::array<int, 3> fine{cells[0] * parts, cells[1] * parts, cells[2] * parts};
  const auto corner = [&](const std::array<int, 3>& node) {
    Point3 x;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      x[axis] = low[axis] + (high[axis] - low[axis]) * node[axis] / cells[axis];
    }
    return x;
  };
  HexBox box;
  for (int c = 0; c <= fine[2]; ++c) {
    for (int b = 0; b <= fine[1]; ++b) {
      for (int a = 0; a <= fine[0]; ++a) {
        const std::array<int, 3> node{a, b, c};
        std::array<int, 3> cell;
        double u[3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
          cell[axis] = std::min(node[axis] / parts, cells[axis] - 1);
          u[axis] = static_cast<double>(node[axis]) / parts - cell[axis];
        }
        Point3 rest{0, 0, 0}, now{0, 0, 0};
        for (int corner_bits = 0; corner_bits < 8; ++corner_bits) {
          double weight = 1;
          std::array<int, 3> at = cell;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const int far = corner_bits >> axis & 1;
            at[axis] += far;
            weight *= far != 0 ? u[axis] : 1 - u[axis];
          }
          const Point3 x = corner(at), y = deform(x);
          for (std::size_t axis = 0; axis < 3; ++axis) {
            rest[axis] += weight * x[axis];
            now[axis] += weight * y[axis];
          }
        }
        box.mesh.rest_positions.push_back(rest);
        box.deformed.push_back(now);
      }
    }
  }
  for (int c = 0; c < fine[2]; ++c) {
    for (int b = 0; b < fine[1]; ++b) {
      for (int a = 0; a < fine[0]; ++a) {
        std::array<std::int32_t, 8> hex;
        for (int n = 0; n < 8; ++n) {
          const int i = a + unit_corner(n, 0), j = b + unit_corner(n, 1), k = c + unit_corner(n, 2);
          hex[static_cast<std::size_t>(n)] = (k * (fine[1] + 1) + j) * (fine[0] + 1) + i;
        }
        box.mesh.hexes.push_back(hex);
      }
    }
  }
  return box;
}

/// A smooth bend and twist of about `amount` voxels, far from affine.
inline Mapping bent(double amount) {
  return [amount](const Point3& x) {
    return Point3{x[0] + amount * std::sin(0.21 * x[1] + 0.05 * x[2]),
                  x[1] + amount * std::sin(0.17 * x[2] + 1) + 0.05 * amount * x[0],
                  x[2] + amount * std::cos(0.19 * x[0] - 0.1 * x[1])};
  };
}

}  // namespace tetwarp::test
