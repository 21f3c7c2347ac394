/// @file pixel_range.cpp
#include "host/cli/pixel_range.hpp"

#include <cmath>
#include <limits>

#include "host/base/pixel_dispatch.hpp"

namespace tetwarp::cli {

namespace {

template <class T>
PixelRange range_of_samples(const Volume& volume) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  PixelRange range{nan, nan};
  for (const T sample : volume.samples<T>()) {
    // fmin and fmax prefer the number over a NaN.
    range.min = std::fmin(range.min, static_cast<double>(sample));
    range.max = std::fmax(range.max, static_cast<double>(sample));
  }
  return range;
}

}  // namespace

PixelRange range_of(const Volume& volume) {
  PixelRange range;
  with_pixel_type(volume.type, [&]<class T>(T) { range = range_of_samples<T>(volume); });
  return range;
}

}  // namespace tetwarp::cli
