/// @file pixel_range.hpp
#pragma once
#include <tetwarp/volume.hpp>

namespace tetwarp::cli {

/// Smallest and largest sample, NaN left out; NaN when nothing else is there.
struct PixelRange {
  double min;
  double max;
};

PixelRange range_of(const Volume& volume);

}  // namespace tetwarp::cli
