/// @file any_number.hpp
/// Arrays whose number type is known at run time only, read and written as float64. Each access
/// evaluates a switch: for stages that compute much more than they read.
#pragma once
#include <cstdint>
#include <tetwarp/choices.hpp>
#include <type_traits>

#include "kernels/base/hd.hpp"
#include "kernels/base/pixel.hpp"

namespace tetwarp {

/// Calls work(T*) with `data` as a pointer to numbers of type `kind`. Does nothing for 64-bit
/// integers, which float64 cannot represent.
template <class Work>
TETWARP_HD void with_numbers(void* data, PixelType kind, Work&& work) {
  switch (kind) {
    case PixelType::uint8:
      return work(static_cast<std::uint8_t*>(data));
    case PixelType::int8:
      return work(static_cast<std::int8_t*>(data));
    case PixelType::uint16:
      return work(static_cast<std::uint16_t*>(data));
    case PixelType::int16:
      return work(static_cast<std::int16_t*>(data));
    case PixelType::uint32:
      return work(static_cast<std::uint32_t*>(data));
    case PixelType::int32:
      return work(static_cast<std::int32_t*>(data));
    case PixelType::float32:
      return work(static_cast<float*>(data));
    case PixelType::float64:
      return work(static_cast<double*>(data));
    case PixelType::uint64:
    case PixelType::int64:
      return;
  }
}

/// An array of numbers of type `kind`.
struct NumberView {
  void* data;
  PixelType kind;

  TETWARP_HD_RARE double at(std::int64_t i) const {
    double number = 0;
    with_numbers(data, kind,
                 [&](const auto* numbers) { number = static_cast<double>(numbers[i]); });
    return number;
  }
  /// Converts to `kind`; integers are rounded half to even and saturate.
  TETWARP_HD_RARE void set(std::int64_t i, double number) const {
    with_numbers(data, kind, [&](auto* numbers) {
      numbers[i] = rounded_to<std::remove_reference_t<decltype(*numbers)>>(number);
    });
  }
};

/// A view of numbers of type T.
/// @pre set() is called only on views of arrays that are not const
template <class T>
NumberView number_view(const T* numbers) {
  return {const_cast<T*>(numbers), pixel_type_of<T>()};
}

}  // namespace tetwarp
