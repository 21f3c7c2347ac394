/// @file box_sums.hpp
/// Which warps have voxels that are not samples at their centers.
#pragma once
#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Whether an output voxel is a label by volume.
inline bool takes_majority(const WarpOptions& options) {
  return options.filter == Filter::labels && options.label_rule == LabelRule::volume;
}

/// Whether an output voxel is a label by Gaussian weights.
inline bool takes_gaussian(const WarpOptions& options) {
  return options.filter == Filter::labels && options.label_rule == LabelRule::gaussian;
}

/// Whether output voxels are sums over their boxes, not samples at their centers.
inline bool sums_boxes(const WarpOptions& options) {
  return options.intensity == Intensity::conservative || takes_majority(options);
}

}  // namespace tetwarp
