/// @file operator_taps.hpp
/// Weights of a filter at a position in the source, and how they change with it, in float64.
#pragma once
#include <array>
#include <cstdint>

#include <tetwarp/choices.hpp>

#include "kernels/warp/sample/volume_filter.hpp"

namespace tetwarp {

/// A position in the source: integer voxel plus local part [voxel].
struct SourcePlace {
  int whole[3];
  double at[3];
};

/// The samples that a position reads, as products of weights along three axes.
struct OperatorTaps {
  int count[3];
  std::int64_t offset[3][max_taps];  ///< [voxel] in the array of the source
  double weight[3][max_taps];
  double slope[3][max_taps];  ///< derivative of the weights by the position; not set for nearest
};

/// Sets the taps of any filter but labels.
/// @param dims  voxels of the source
/// @returns whether the source is defined there; else nothing is set
bool set_taps(const std::array<std::int64_t, 3>& dims,
              Filter filter,
              const SourcePlace& place,
              OperatorTaps& taps);

}  // namespace tetwarp
