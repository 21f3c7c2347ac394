/// @file resample_blocks.hpp
/// The parts in which a volume is resampled that does not fit in memory with its source and fields.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/field_reader.hpp>
#include <tetwarp/resample.hpp>

#include "host/warp/resample_part.hpp"

namespace tetwarp {

/// Limits of a part, and the memory that a voxel takes [byte].
struct PartLimits {
  double bytes;                      ///< of windows and output together
  double source_voxel = 4;           ///< one voxel of the sources that are in memory
  double output_voxel = 4;           ///< the same of outputs
  std::array<std::int64_t, 2> step;  ///< parts begin at multiples of so many rows and slices
  /// Larger parts of the output are divided while they are more than a step.
  std::int64_t most_voxels = std::numeric_limits<std::int64_t>::max();
};

/// Divides an output, halving it along its slices, then its rows, until each part is within the
/// limits. What a part reads of a field follows from where the links before it may take the part:
/// the fields of a part are read before its window of the source is known.
class TETWARP_EXPORT ResampleBlocks {
 public:
  /// @param transform  kept by the caller; its fields need no displacements
  /// @param fields     one per link of the transform
  ResampleBlocks(const Grid& source,
                 const Grid& output,
                 const Transform& transform,
                 std::vector<FieldReader> fields,
                 Filter filter,
                 const PartLimits& limits);

  /// The next part with its windows of fields read, and a window of the source without ranges;
  /// nothing after the last one.
  /// @throws std::invalid_argument  when a part of one step exceeds the limits
  std::optional<ResamplePart> next();

  /// Memory of the last part, also of one that exceeds the limits, as far as it is known [byte].
  double bytes() const { return bytes_; }

 private:
  /// The windows of a part; nothing: they exceed the limits.
  std::optional<ResamplePart> part_of(const Region& region);
  /// Halves a region, the first half last in the list. @returns false if it is one step
  bool divide(const Region& region);

  Grid source_, output_;
  std::vector<SingleTransform> links_;  ///< without displacements
  std::vector<FieldReader> fields_;
  int reach_;
  PartLimits limits_;
  std::vector<Region> left_;  ///< the next one last
  double bytes_ = 0;
};

}  // namespace tetwarp
