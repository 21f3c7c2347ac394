/// @file vtkhdf_array.hpp
/// One point array of a VTKHDF ImageData, written chunk by chunk without a copy of the samples.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "io/h5/h5.hpp"
#include "io/vtkhdf/vtkhdf_output.hpp"

namespace tetwarp {

/// For arrays that are written whole: whole rows of x, as many of y and then of z as fit in 256
/// KiB. Rows above 1 MiB are cut.
/// @returns edges in voxels, x first
std::array<std::int64_t, 3> row_chunk(const std::array<std::int64_t, 3>& dims,
                                      std::int64_t voxel_bytes);

/// For arrays that are written in blocks: nearly a cube, edges of powers of two from 8 on, as many
/// voxels as fit in 256 KiB.
std::array<std::int64_t, 3> brick_chunk(const std::array<std::int64_t, 3>& dims,
                                        std::int64_t voxel_bytes);

/// Axes of a dataset of samples, the slowest first: VTK's readers expect none of a single sample,
/// but one axis of a single voxel in a static file.
std::vector<std::size_t> axes_in_file(const std::array<std::int64_t, 3>& dims, bool is_temporal);

/// The bytes of one sample: `value` rounded half to even and saturated to the type; NaN is 0 in
/// integers.
std::vector<std::byte> sample_bytes(PixelType type, double value);

/// A dataset [z][y][x] or [z][y][x][component], with [t] before in temporal files. Chunks that hold
/// only the background are not stored unless the options require it: it is the dataset's fill
/// value.
class ArrayWriter {
 public:
  /// Creates the dataset in `output`, which must outlive this object.
  ArrayWriter(const VtkhdfOutput& output,
              const h5::Object& point_data,
              const std::array<std::int64_t, 3>& dims,
              const ArrayHeader& header,
              const std::array<std::int64_t, 3>& chunk,
              const VolumeWriteOptions& options,
              bool is_temporal);

  /// Marks the array as the active scalars, as VTKHDF 2.6 does.
  void mark_scalars() const;

  /// Extends the time axis to this number of rows.
  void grow(std::int64_t rows) const;

  /// Writes a region that begins and ends at chunks, in temporal files of row `row` of the time
  /// axis, and counts its chunks.
  /// @param samples  [k][j][i][component] of the region
  void write(const Region& region,
             const void* samples,
             std::int64_t row,
             WrittenFile& written) const;

 private:
  bool is_background(const Region& chunk, const Region& region, const void* samples) const;
  void write_chunk(const Region& chunk,
                   const Region& region,
                   const void* samples,
                   std::int64_t row) const;

  const VtkhdfOutput* output_;
  h5::Object dataset_;
  std::array<std::int64_t, 3> dims_;
  std::vector<std::size_t> axes_;  ///< of the dataset; see axes_in_file()
  PixelType type_;
  int components_;
  bool is_temporal_;
  std::array<std::int64_t, 3> chunk_;
  std::vector<std::byte> background_;
  bool skips_background_;
};

}  // namespace tetwarp
