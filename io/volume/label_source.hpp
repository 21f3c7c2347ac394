/// @file label_source.hpp
/// Labels that a file holds as floats.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/files/volume_source.hpp"

namespace tetwarp {

/// Reads whole numbers of float32 or float64 as int32.
class LabelSource : public VolumeSource {
 public:
  /// @param path   for messages
  /// @param floats @pre its type is float32 or float64
  LabelSource(std::string path, std::unique_ptr<VolumeSource> floats);

  const Grid& grid() const override { return floats_->grid(); }
  const ArrayHeader& array() const override { return array_; }
  std::vector<std::string> array_names() const override { return floats_->array_names(); }
  double chunk_bytes() const override;
  double unpacked_bytes() const override { return floats_->unpacked_bytes(); }
  /// @throws IoError on a sample that is no whole number of int32
  void read(const Region& region, void* samples) override;

 private:
  std::string path_;
  std::unique_ptr<VolumeSource> floats_;
  ArrayHeader array_;
};

}  // namespace tetwarp
