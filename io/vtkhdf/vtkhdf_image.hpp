/// @file vtkhdf_image.hpp
/// A VTKHDF ImageData file that is being written: static, Version [1,0], or temporal, [2,0].
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "io/files/volume_sink.hpp"
#include "io/vtkhdf/vtkhdf_array.hpp"
#include "io/vtkhdf/vtkhdf_output.hpp"

namespace tetwarp {

/// Throws IoError unless the compression level is 0 to 9.
void check_compression(const std::string& path, const VolumeWriteOptions& options);

/// Throws what ImageFile throws about names, grid and compression, and writes nothing.
void check_image_file(const std::string& path,
                      const Grid& grid,
                      const std::vector<ArrayHeader>& arrays,
                      const VolumeWriteOptions& options);

/// Writes the samples of its arrays region by region.
class ImageFile : public VolumeSink {
 public:
  /// Creates the file under a temporary name, its arrays empty.
  /// @param chunks  edges of each array's chunks in voxels, x first
  /// @throws IoError on a name that VTKHDF cannot hold, or a file that cannot be created
  ImageFile(const std::string& path,
            const Grid& grid,
            const std::vector<ArrayHeader>& arrays,
            const std::vector<std::array<std::int64_t, 3>>& chunks,
            const VolumeWriteOptions& options,
            bool is_temporal);

  const Grid& grid() const { return grid_; }
  const std::vector<ArrayHeader>& arrays() const { return headers_; }

  /// Begins a step of a temporal file.
  void begin_step(double time) override;
  /// A step equal to the last one: its offset is repeated.
  void repeat_step(double time) override;

  /// Writes a region of an array, in temporal files of the step begun last.
  /// @param region   begins and ends at multiples of the array's chunk, or at the grid's end
  /// @param samples  [k][j][i][component] of the region
  void write(std::size_t array, const Region& region, const void* samples) override;

  /// Writes the group of steps, flushes and moves the file to its name.
  WrittenFile finish() override;

 private:
  void write_steps();

  std::string path_;
  Grid grid_;
  std::vector<ArrayHeader> headers_;
  bool is_temporal_;
  VtkhdfOutput output_;
  h5::Object point_data_;
  std::vector<ArrayWriter> arrays_;
  WrittenFile written_;
  std::vector<double> times_;
  std::vector<std::int64_t> rows_;  ///< of the time axis, one per step
};

}  // namespace tetwarp
