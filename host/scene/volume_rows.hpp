/// @file volume_rows.hpp
/// Rows of voxels of a volume, and single ones, as float64, or their distance from a threshold.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/volume.hpp>

#include "host/base/pixel_dispatch.hpp"
#include "host/base/sample_level.hpp"

namespace tetwarp {

/// Reads a volume row by row. @pre one component, and as many samples as the grid has voxels
class VolumeRows {
 public:
  /// @param threshold  is subtracted from the samples, with exact signs
  explicit VolumeRows(const Volume& volume, double threshold = 0)
      : volume_(volume),
        threshold_(threshold),
        row_(static_cast<std::size_t>(volume.grid.dims[0])) {}

  /// Samples (0, j, k) to (dims[0] - 1, j, k) minus the threshold. Valid until the next call.
  const std::vector<double>& row(std::int64_t j, std::int64_t k) {
    with_pixel_type(volume_.type, [&]<class T>(T) {
      const auto index = static_cast<std::size_t>(k * volume_.grid.dims[1] + j);
      const T* sample = volume_.samples<T>().data() + index * row_.size();
      for (std::size_t i = 0; i < row_.size(); ++i) row_[i] = level_of(sample[i], threshold_);
    });
    return row_;
  }

 private:
  const Volume& volume_;
  double threshold_;
  std::vector<double> row_;
};

/// The sample of a voxel i, j, k minus a threshold, with its exact sign. @pre as VolumeRows
inline double sample_of(const Volume& volume,
                        const std::array<std::int64_t, 3>& voxel,
                        double threshold = 0) {
  const auto& dims = volume.grid.dims;
  const std::int64_t place = (voxel[2] * dims[1] + voxel[1]) * dims[0] + voxel[0];
  double value = 0;
  with_pixel_type(volume.type, [&]<class T>(T) {
    value = level_of(volume.samples<T>()[static_cast<std::size_t>(place)], threshold);
  });
  return value;
}

}  // namespace tetwarp
