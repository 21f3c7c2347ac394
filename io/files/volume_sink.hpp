/// @file volume_sink.hpp
/// What BlockVolumeWriter writes to: a file format.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

namespace tetwarp {

/// A file that is written region by region. Calls and errors as of BlockVolumeWriter.
class VolumeSink {
 public:
  VolumeSink() = default;
  VolumeSink(const VolumeSink&) = delete;
  VolumeSink& operator=(const VolumeSink&) = delete;
  virtual ~VolumeSink() = default;

  virtual void begin_step(double time) = 0;
  virtual void repeat_step(double time) = 0;
  virtual void write(std::size_t array, const Region& region, const void* samples) = 0;
  virtual WrittenFile finish() = 0;
};

}  // namespace tetwarp
