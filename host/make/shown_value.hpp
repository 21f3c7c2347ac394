/// @file shown_value.hpp
/// The number that pictures show of a voxel.
#pragma once
#include <cmath>

namespace tetwarp {

/// The sample or, of several components, their Euclidean norm.
template <class T>
double shown_value(const T* sample, int components) {
  if (components == 1) return static_cast<double>(*sample);
  double sum = 0;
  for (int c = 0; c < components; ++c) {
    sum += static_cast<double>(sample[c]) * static_cast<double>(sample[c]);
  }
  return std::sqrt(sum);
}

}  // namespace tetwarp
