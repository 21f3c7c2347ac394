/// @file pixel_dispatch.hpp
/// Calls of templates with the C++ type of a PixelType.
#pragma once
#include <cstdint>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Calls work(T{}), where T is the C++ type of `type`.
template <class Work>
void with_pixel_type(PixelType type, Work&& work) {
  switch (type) {
    case PixelType::uint8:
      return work(std::uint8_t{});
    case PixelType::int8:
      return work(std::int8_t{});
    case PixelType::uint16:
      return work(std::uint16_t{});
    case PixelType::int16:
      return work(std::int16_t{});
    case PixelType::uint32:
      return work(std::uint32_t{});
    case PixelType::int32:
      return work(std::int32_t{});
    case PixelType::uint64:
      return work(std::uint64_t{});
    case PixelType::int64:
      return work(std::int64_t{});
    case PixelType::float32:
      return work(float{});
    case PixelType::float64:
      return work(double{});
  }
}

}  // namespace tetwarp
