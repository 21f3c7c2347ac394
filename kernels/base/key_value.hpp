/// @file key_value.hpp
/// A key, a flag and a value in one sortable word.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// key << 32, then flag << 31, then the value. Sorting by the upper half alone, stably, gives the
/// order key, then value, of entries made in the order of their values.
using KeyValue = std::uint64_t;

constexpr KeyValue no_key_value = ~KeyValue{0};
constexpr std::uint32_t flag_bit = 0x80000000u;

/// @param key    below 2^32
/// @param value  below 2^31
TETWARP_HD KeyValue make_key_value(std::int64_t key, std::int64_t value, bool flag = false) {
  return static_cast<KeyValue>(key) << 32 | (flag ? flag_bit : 0u) | static_cast<KeyValue>(value);
}
TETWARP_HD std::int64_t key_of(KeyValue entry) {
  return static_cast<std::int64_t>(entry >> 32);
}
TETWARP_HD std::int32_t value_of(KeyValue entry) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(entry) & ~flag_bit);
}
TETWARP_HD bool flag_of(KeyValue entry) {
  return (entry & flag_bit) != 0;
}

}  // namespace tetwarp
