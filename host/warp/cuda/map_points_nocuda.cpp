/// @file map_points_nocuda.cpp
/// Back end cuda of map_points() in a build without the CUDA toolkit: choose_backend() refuses it.
#include <tetwarp/error.hpp>
#include <tetwarp/map_points.hpp>

#include "host/base/point_backend.hpp"

namespace tetwarp {

void move_points_cuda(const PointPlan&, MappedPoints&) {
  throw CudaError("this build has no CUDA; build with the CUDA toolkit installed");
}

}  // namespace tetwarp
