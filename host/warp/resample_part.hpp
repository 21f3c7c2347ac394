/// @file resample_part.hpp
/// A part of the output of resample(), from windows of the sources and of the fields, for those
/// larger than memory. The parts together equal resample() bit for bit.
#pragma once
#include <span>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/resample.hpp>

namespace tetwarp {

/// Displacements of a part of a field's grid.
struct FieldWindow {
  Region region;                    ///< of the field's grid
  std::vector<float> displacement;  ///< as of DisplacementField, of the region
};

/// What is computed at a time, and what is in memory for it.
struct ResamplePart {
  Region output;        ///< whole rows of the output grid
  SourceWindow source;  ///< what the data of the sources hold
  /// One per link of the transform, which are not used of affine links and splines; empty: the
  /// transform holds the displacements.
  std::vector<FieldWindow> fields = {};
};

/// Computes a part.
/// @param sources  as of resample(), whose data hold the window
/// @param outputs  one array per source, [k][j][i][component] over the part
/// @pre   windows hold what ResampleBlocks states
/// @throws  as resample(); std::invalid_argument for a window that is not within its grid, or a
///          filter that needs a whole source
TETWARP_EXPORT void resample_part(std::span<const VolumeView> sources,
                                  const Transform& transform,
                                  const ResampleOptions& options,
                                  const ResamplePart& part,
                                  std::span<void* const> outputs,
                                  const Progress& progress = {});

}  // namespace tetwarp
