/// @file map_points_cuda.cu
/// Back end cuda of map_points().
#include <tetwarp/map_points.hpp>

#include "host/warp/point_run.hpp"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

void move_points_cuda(const PointPlan& plan, MappedPoints& result) {
  const DeviceScope scope(plan.device);
  CudaExec exec(plan.device, StageClocks::off);
  move_points(exec, plan, result);
}

}  // namespace tetwarp
