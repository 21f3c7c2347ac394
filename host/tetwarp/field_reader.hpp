/// @file field_reader.hpp
/// Displacement fields that are not in memory.
#pragma once
#include <functional>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Reads the displacements of a field.
struct FieldReader {
  /// Reads those of a region of the field's grid.
  /// @param displacement  out, as of DisplacementField, of the region
  std::function<void(const Region& region, float* displacement)> read;
  double voxel_bytes = 12;    ///< memory for a voxel while it is read, its displacement included
  double chunk_bytes = 0;     ///< memory that reading takes beside, as of VolumeReader
  double unpacked_bytes = 0;  ///< disk that it takes for regions that are not the whole grid
};

}  // namespace tetwarp
