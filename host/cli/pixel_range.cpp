/// @file pixel_range.cpp
#include "host/cli/pixel_range.hpp"

#include <cmath>
#include <limits>

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
  switch (volume.type) {
    case PixelType::uint8:
      return range_of_samples<std::uint8_t>(volume);
    case PixelType::int8:
      return range_of_samples<std::int8_t>(volume);
    case PixelType::uint16:
      return range_of_samples<std::uint16_t>(volume);
    case PixelType::int16:
      return range_of_samples<std::int16_t>(volume);
    case PixelType::uint32:
      return range_of_samples<std::uint32_t>(volume);
    case PixelType::int32:
      return range_of_samples<std::int32_t>(volume);
    case PixelType::uint64:
      return range_of_samples<std::uint64_t>(volume);
    case PixelType::int64:
      return range_of_samples<std::int64_t>(volume);
    case PixelType::float32:
      return range_of_samples<float>(volume);
    case PixelType::float64:
      break;
  }
  return range_of_samples<double>(volume);
}

}  // namespace tetwarp::cli
