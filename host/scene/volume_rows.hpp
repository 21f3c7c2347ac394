/// @file volume_rows.hpp
/// Rows of voxels of a volume, and single ones, as float64.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/volume.hpp>

#include "host/base/pixel_dispatch.hpp"

namespace tetwarp {

/// Reads a volume row by row. @pre one component, and as many samples as the grid has voxels
class VolumeRows {
 public:
  explicit VolumeRows(const Volume& volume)
      : volume_(volume), row_(static_cast<std::size_t>(volume.grid.dims[0])) {}

  /// Samples (0, j, k) to (dims[0] - 1, j, k). Valid until the next call.
  const std::vector<double>& row(std::int64_t j, std::int64_t k) {
    with_pixel_type(volume_.type, [&]<class T>(T) {
      const auto index = static_cast<std::size_t>(k * volume_.grid.dims[1] + j);
      const T* sample = volume_.samples<T>().data() + index * row_.size();
      for (std::size_t i = 0; i < row_.size(); ++i) row_[i] = static_cast<double>(sample[i]);
    });
    return row_;
  }

 private:
  const Volume& volume_;
  std::vector<double> row_;
};

/// The sample of a voxel i, j, k. @pre as VolumeRows
inline double sample_of(const Volume& volume, const std::array<std::int64_t, 3>& voxel) {
  const auto& dims = volume.grid.dims;
  const std::int64_t place = (voxel[2] * dims[1] + voxel[1]) * dims[0] + voxel[0];
  double value = 0;
  with_pixel_type(volume.type, [&]<class T>(T) {
    value = static_cast<double>(volume.samples<T>()[static_cast<std::size_t>(place)]);
  });
  return value;
}

}  // namespace tetwarp
