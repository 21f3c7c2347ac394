/// @file eigen_points.hpp
/// Points as vectors of Eigen.
#pragma once
#include <Eigen/Core>
#include <tetwarp/volume.hpp>

namespace tetwarp::test {

inline Eigen::Vector3d vector_of(const Point3& x) {
  return {x[0], x[1], x[2]};
}

}  // namespace tetwarp::test
