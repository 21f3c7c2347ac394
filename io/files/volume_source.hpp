/// @file volume_source.hpp
/// What VolumeReader reads from: an array of a file, of any format.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

namespace tetwarp {

/// One array at one step. Calls and errors as of VolumeReader.
class VolumeSource {
 public:
  VolumeSource() = default;
  VolumeSource(const VolumeSource&) = delete;
  VolumeSource& operator=(const VolumeSource&) = delete;
  virtual ~VolumeSource() = default;

  virtual const Grid& grid() const = 0;
  virtual const ArrayHeader& array() const = 0;
  virtual std::vector<std::string> array_names() const = 0;
  virtual double chunk_bytes() const = 0;
  virtual double unpacked_bytes() const { return 0; }
  virtual void read(const Region& region, void* samples) = 0;
};

}  // namespace tetwarp
