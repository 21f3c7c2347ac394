/// @file picture_meter.hpp
/// PictureMeter: how many pictures are drawn, and what they take.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/base/stopwatch.hpp"
#include "host/view/live_simulation.hpp"

namespace tetwarp::view {

class PictureMeter {
 public:
  /// @param simulation  whose thread draws nothing; kept by the caller
  explicit PictureMeter(LiveSimulation& simulation) : simulation_(simulation) {}

  /// Each picture.
  void drew();
  /// After the first picture, for which shaders are compiled, and after the last one, while the
  /// simulation has its thread.
  void begin();
  void end();

  std::size_t last_second() const { return recent_.size(); }
  /// Pictures from begin() on.
  std::int64_t count() const { return count_ - first_count_; }
  /// Pictures a second of wall time from begin() to end().
  double rate() const { return rate_; }
  /// Processor time of each, which is all that the other threads do if the simulation has one [s].
  double seconds() const { return seconds_; }

 private:
  double drawing_seconds();

  LiveSimulation& simulation_;
  std::vector<Stopwatch> recent_;  ///< since each picture of the last second
  std::int64_t count_ = 0, first_count_ = 0;
  Stopwatch since_first_;
  double first_drawing_ = 0, rate_ = 0, seconds_ = 0;
};

}  // namespace tetwarp::view
