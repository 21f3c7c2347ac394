/// @file picture_meter.cpp
/// Clocks of the wall, the process and the thread of the simulation.
#include "host/view/window/picture_meter.hpp"

#include <algorithm>
#include <ctime>

namespace tetwarp::view {

void PictureMeter::drew() {
  std::erase_if(recent_, [](const Stopwatch& since) { return since.seconds() > 1; });
  recent_.emplace_back();
  ++count_;
}

void PictureMeter::begin() {
  first_count_ = count_;
  since_first_ = Stopwatch();
  first_drawing_ = drawing_seconds();
}

void PictureMeter::end() {
  const auto pictures = static_cast<double>(count());
  rate_ = pictures / since_first_.seconds();
  seconds_ = (drawing_seconds() - first_drawing_) / std::max(pictures, 1.0);
}

/// Of all threads but that of the simulation.
double PictureMeter::drawing_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC - simulation_.thread_seconds();
}

}  // namespace tetwarp::view
