/// @file step_shares.hpp
/// What the stages of a step take of its time, for its progress.
#pragma once
#include <cstddef>
#include <vector>

#include "host/warp/box_sums.hpp"
#include "host/warp/geometry.hpp"

namespace tetwarp {

/// The part of a part from one fraction of it to another.
inline ProgressPart part_of(const ProgressPart& part, double from, double to) {
  return {part.progress, part.begin + part.share * from, part.share * (to - from)};
}

/// Estimated times of the stages, in units of a plain raster of one source. Measured on the torso
/// phantom on a CPU, rounded: they place the stages on a progress bar and change no result.
struct StepShares {
  double setup = 0.1;           ///< tetrahedra and cells
  double fold = 0;              ///< counts of folded voxels
  std::vector<double> sources;  ///< per source
  double fields = 0;

  StepShares(const WarpPlan& plan, const FieldTarget& to) {
    constexpr double with_transforms = 6, box_sums = 70, fold_count = 10, field = 0.7;
    if (plan.options.count_folded) fold = fold_count;
    for (std::size_t s = 0; s < plan.sources.size(); ++s) {
      const bool is_plain =
          plan.options.intensity == Intensity::value &&
          (plan.options.quantities.empty() || plan.options.quantities[s] == Quantity::components);
      sources.push_back(sums_boxes(plan.options) ? box_sums : is_plain ? 1 : with_transforms);
    }
    for (const float* one : {to.displacement, to.jacobian, to.gradient, to.strain, to.forward}) {
      if (one != nullptr) fields += field;
    }
  }

  /// The part of the step's progress that belongs to source s.
  ProgressPart of_source(std::size_t s, const Progress& progress) const {
    double before = setup + fold, all = setup + fold + fields;
    for (std::size_t other = 0; other < sources.size(); ++other) {
      all += sources[other];
      if (other < s) before += sources[other];
    }
    return {progress, before / all, sources[s] / all};
  }
};

}  // namespace tetwarp
