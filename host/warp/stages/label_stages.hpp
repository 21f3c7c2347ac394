/// @file label_stages.hpp
/// Stages of labels by volume and by Gaussian weights, as the pipeline calls them.
#pragma once
#include <algorithm>
#include <cstdint>

#include "host/base/warp_backend.hpp"
#include "host/warp/geometry.hpp"
#include "kernels/warp/overlap/voxel_majority.hpp"
#include "kernels/warp/voxel_gaussian.hpp"

namespace tetwarp {

/// Sets all voxels of the output, in parts between which a step reports its progress.
template <class Exec>
void majority_stage(Exec& exec, VoxelMajorityOp op, const ProgressPart& progress) {
  constexpr std::int64_t parts = 64, least = 1 << 14;
  const std::int64_t count = op.frame.voxel_count();
  const std::int64_t size = std::max(least, (count + parts - 1) / parts);
  for (; op.first < count; op.first += size) {
    progress.report(static_cast<double>(op.first) / static_cast<double>(count));
    voxel_majority(exec, op, std::min(size, count - op.first));
  }
  progress.report(1.0);
}

/// The labels of a source by the Gaussian of options.
/// @param labels  of the whole source, [k][j][i]
inline GaussianLabels gaussian_labels(const Grid& source,
                                      NumberView labels,
                                      const LabelGaussian& gaussian,
                                      double background) {
  GaussianLabels result = {
      labels, {}, {gaussian.sigma, gaussian.sigma * gaussian.cutoff}, background};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.dims[axis] = static_cast<int>(source.dims[axis]);
  }
  return result;
}

}  // namespace tetwarp
