/// @file operator_plan.cpp
/// Checks the arguments of a WarpOperator.
#include "host/warp/cpu/operator_plan.hpp"

#include <stdexcept>
#include <string>

#include "host/warp/hex_split.hpp"

namespace tetwarp {
namespace {
void check_options(const WarpOperatorOptions& options, std::int64_t voxels) {
  if (options.filter == Filter::labels) {
    throw std::invalid_argument(
        "filter: labels is not linear in the samples; choose nearest, linear, cubic, bspline or "
        "lanczos");
  }
  if (extends(options.outside)) {
    throw std::invalid_argument(
        "outside: the operator has no displacements beyond the mesh; choose background or "
        "identity");
  }
  if (options.intensity == Intensity::density) {
    throw std::invalid_argument(
        "intensity: the operator has no densities; choose value or conservative");
  }
  if (options.intensity == Intensity::conservative && options.outside != Outside::background) {
    throw std::invalid_argument("intensity: to keep the total, outside must be background");
  }
  if (!options.mask.empty() && std::ssize(options.mask) != voxels) {
    throw std::invalid_argument("mask: expected one number for each of " + std::to_string(voxels) +
                                " voxels of the output, got " +
                                std::to_string(options.mask.size()));
  }
}
}  // namespace

WarpPlan operator_plan(const Grid& source, const Mesh& mesh, const WarpOperatorOptions& options) {
  const Grid output = options.output_grid.value_or(source);
  check_grid(source, "source");
  check_grid(output, "output grid");
  check_mesh(mesh);
  check_options(options, output.voxel_count());
  WarpPlan plan;
  plan.sources = {VolumeView(source, PixelType::float64, 1, nullptr, Memory::host)};
  plan.mesh = with_split_hexes(mesh);
  plan.options.intensity = options.intensity;
  plan.options.outside = options.outside;
  plan.output_grid = output;
  plan.region = {{0, 0, 0}, output.dims};
  return plan;
}

}  // namespace tetwarp
