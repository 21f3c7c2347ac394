/// @file vtkhdf_array.hpp
/// One point array of a VTKHDF ImageData, written chunk by chunk straight from the volume's memory.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "io/h5.hpp"
#include "io/vtkhdf_output.hpp"

namespace tetwarp {

/// Whole rows of x, as many of y and then of z as fit in 256 KiB. Rows above 1 MiB are cut.
/// @returns edges in voxels, x first
std::array<std::int64_t, 3> chunk_dims(const Volume& volume);

/// The bytes of one sample: `value` rounded half to even and saturated to the type; NaN is 0 in
/// integers.
std::vector<std::byte> sample_bytes(PixelType type, double value);

/// A dataset [z][y][x] or [z][y][x][component], with [t] before in temporal files. Chunks that hold
/// only the background are not stored, unless asked for: it is the dataset's fill value.
class ArrayWriter {
 public:
  /// Creates the dataset for arrays like `volume` in `output`, which must live longer.
  ArrayWriter(const VtkhdfOutput& output,
              const h5::Object& point_data,
              const Volume& volume,
              const VolumeWriteOptions& options,
              bool is_temporal);

  /// Writes `volume`, in temporal files as row `row` of the time axis, and counts its chunks.
  void write(const Volume& volume, std::int64_t row, WrittenFile& written) const;

  /// False unless `volume` has the name, type and shape the dataset was made for.
  bool fits(const Volume& volume) const;

  const std::string& name() const { return name_; }

 private:
  bool is_background(const Volume& volume,
                     const std::array<std::int64_t, 3>& begin,
                     const std::array<std::int64_t, 3>& end) const;
  void write_chunk(const Volume& volume,
                   std::int64_t row,
                   const std::array<std::int64_t, 3>& begin,
                   const std::array<std::int64_t, 3>& end) const;

  const VtkhdfOutput* output_;
  h5::Object dataset_;
  std::string name_;
  std::array<std::int64_t, 3> dims_;
  PixelType type_;
  int components_;
  bool is_temporal_;
  std::array<std::int64_t, 3> chunk_;
  std::vector<std::byte> background_;
  bool skips_background_;
};

}  // namespace tetwarp
