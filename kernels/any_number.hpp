/// @file any_number.hpp
/// Samples whose type is known at run time only, as float64: for stages that compute far more than
/// they read.
#pragma once
#include <cstdint>
#include <type_traits>

#include "kernels/hd.hpp"
#include "kernels/volume_sample.hpp"

namespace tetwarp {

enum class NumberKind : int { uint8, int8, uint16, int16, uint32, int32, float32, float64 };

template <class T>
constexpr NumberKind number_kind_of() {
  if constexpr (std::is_same_v<T, double>) return NumberKind::float64;
  if constexpr (std::is_same_v<T, float>) return NumberKind::float32;
  constexpr int size = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 2 : 4;
  return static_cast<NumberKind>(size + (std::is_signed_v<T> ? 1 : 0));
}

/// Calls work(T*) with the data as numbers of their type.
template <class Work>
TETWARP_HD void with_numbers(void* data, NumberKind kind, Work&& work) {
  switch (kind) {
    case NumberKind::uint8:
      return work(static_cast<std::uint8_t*>(data));
    case NumberKind::int8:
      return work(static_cast<std::int8_t*>(data));
    case NumberKind::uint16:
      return work(static_cast<std::uint16_t*>(data));
    case NumberKind::int16:
      return work(static_cast<std::int16_t*>(data));
    case NumberKind::uint32:
      return work(static_cast<std::uint32_t*>(data));
    case NumberKind::int32:
      return work(static_cast<std::int32_t*>(data));
    case NumberKind::float32:
      return work(static_cast<float*>(data));
    case NumberKind::float64:
      return work(static_cast<double*>(data));
  }
}

/// Samples of a kind.
struct NumberView {
  void* data;
  NumberKind kind;

  TETWARP_HD_RARE double at(std::int64_t i) const {
    double number = 0;
    with_numbers(data, kind,
                 [&](const auto* numbers) { number = static_cast<double>(numbers[i]); });
    return number;
  }
  /// Rounds once, saturates.
  TETWARP_HD_RARE void set(std::int64_t i, double number) const {
    with_numbers(data, kind, [&](auto* numbers) {
      numbers[i] = rounded_to<std::remove_reference_t<decltype(*numbers)>>(number);
    });
  }
};

/// Numbers of type T, to read or, where the caller may, to write.
template <class T>
NumberView number_view(const T* numbers) {
  return {const_cast<T*>(numbers), number_kind_of<T>()};
}

}  // namespace tetwarp
