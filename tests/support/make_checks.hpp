/// @file make_checks.hpp
/// Helpers of the tests of lattices, deformations, the phantom and pictures.
#pragma once
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <tetwarp/make.hpp>
#include <utility>
#include <vector>

#include "tests/support/eigen_points.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::make_checks {

using PixelTypes = ::testing::Types<std::uint8_t,
                                    std::int8_t,
                                    std::uint16_t,
                                    std::int16_t,
                                    std::uint32_t,
                                    std::int32_t,
                                    std::uint64_t,
                                    std::int64_t,
                                    float,
                                    double>;

using test::vector_of;

/// Volumes of the tetrahedra, positive where the nodes are in right-handed order.
inline std::vector<double> tet_volumes(const Mesh& mesh, const std::vector<Point3>& positions) {
  std::vector<double> volumes;
  for (const auto& tet : mesh.tets) {
    Eigen::Matrix3d edges;
    for (int n = 0; n < 3; ++n) {
      edges.col(n) =
          vector_of(positions[static_cast<std::size_t>(tet[static_cast<std::size_t>(n + 1)])]) -
          vector_of(positions[static_cast<std::size_t>(tet[0])]);
    }
    volumes.push_back(edges.determinant() / 6);
  }
  return volumes;
}

inline double smallest_volume(const Mesh& mesh, const std::vector<Point3>& positions) {
  const std::vector<double> volumes = tet_volumes(mesh, positions);
  return *std::min_element(volumes.begin(), volumes.end());
}

/// All voxels' lattice, or that of the foreground.
inline Mesh lattice_of(const Volume& volume, int cells, std::optional<double> threshold = {}) {
  return make_lattice_mesh(volume, {.cells = cells, .threshold = threshold});
}

using test::message_of;

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace tetwarp::make_checks
