/// @file cloth_body.hpp
/// Springs, bending and mass of cloth.
#pragma once
#include <vector>

#include "host/reference/simulate/vectors.hpp"
#include "host/scene/scene_geometry.hpp"

namespace tetwarp::reference {

/// Force k (l - L) along the line between two nodes.
struct EdgeSpring {
  std::array<int, 2> nodes{};
  double stiffness = 0;    ///< [N/m]
  double rest_length = 0;  ///< [m]
  double gamma = 0;        ///< damping [s]
};

struct ClothBody {
  std::vector<EdgeSpring> springs;  ///< nodes counted within the body
  MatrixXd mass;                    ///< [nodes][nodes] [kg]
  MatrixXd bend;                    ///< energy of bending: 1/2 x^T bend x per axis [N/m]
};

ClothBody cloth_body(const Body& body, const BodyGeometry& geometry);

/// Force on node 0 of a spring; `line` = x_0 - x_1 now.
Vector3d spring_force(const EdgeSpring& spring, const Vector3d& line);

/// -d force / d line, with the part that would be negative in a compressed spring left out:
/// k (max(1 - L/l, 0) (1 - u u^T) + u u^T).
Matrix3d spring_stiffness(const EdgeSpring& spring, const Vector3d& line);

}  // namespace tetwarp::reference
