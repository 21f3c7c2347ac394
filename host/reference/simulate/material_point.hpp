/// @file material_point.hpp
/// Points of bodies: weighted sums of nodes, points fixed in a rigid frame, points of the world;
/// and the material point nearest to a point.
#pragma once
#include <limits>
#include <vector>

#include "host/reference/simulate/vectors.hpp"

namespace tetwarp::reference {

struct MaterialPoint {
  int body = -1;           ///< index in Scene::bodies, -1 where it is none
  std::vector<int> nodes;  ///< of all nodes of the scene; empty: rigid or world
  std::vector<double> weights;
  int rigid = -1;                     ///< index of the frame
  Vector3d local = Vector3d::Zero();  ///< rigid: from its center, axes of the geometry; else world
};

/// A point of a simplex nearest to x: weights of its corners, and the distance.
struct NearestPoint {
  VectorXd weights;
  double distance = std::numeric_limits<double>::infinity();
};

/// Of the convex hull of 1 to 4 points in general position, columns of `corners`.
NearestPoint nearest_of_simplex(const MatrixXd& corners, const Vector3d& x);

/// Whether a closed surface winds around x; columns of `points` are its points.
bool is_enclosed(const std::vector<std::array<std::int32_t, 3>>& triangles,
                 const std::vector<Vector3d>& points,
                 const Vector3d& x);

}  // namespace tetwarp::reference
