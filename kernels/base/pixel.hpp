/// @file pixel.hpp
/// Precision of the arithmetic on samples of a pixel type, and rounding of results to the type.
#pragma once
#include <cstdint>
#include <limits>
#include <type_traits>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// Arithmetic for a pixel type: float32 for 8- and 16-bit integers and float32, else float64.
template <class T>
using ArithmeticOf =
    std::conditional_t<(sizeof(T) <= 2 || std::is_same_v<T, float>), float, double>;

/// Whether samples may be interpolated: not for 64-bit integers, which float64 cannot represent.
template <class T>
constexpr bool can_blend = std::is_floating_point_v<T> || sizeof(T) <= 4;

/// Limits of an integer type as constants that device code may use.
template <class T>
struct IntegerRange {
  static constexpr T low = std::numeric_limits<T>::min();
  static constexpr T high = std::numeric_limits<T>::max();
};

/// Converts a computed value to a pixel type: integers are rounded half to even and saturate.
template <class T, class Real>
TETWARP_HD T rounded_to(Real value) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(value);
  } else {
    const Real whole = rint(value);
    if (whole <= static_cast<Real>(IntegerRange<T>::low)) return IntegerRange<T>::low;
    if (whole >= static_cast<Real>(IntegerRange<T>::high)) return IntegerRange<T>::high;
    return static_cast<T>(whole);
  }
}

}  // namespace tetwarp
