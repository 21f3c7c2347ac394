/// @file number_hash.hpp
/// A hash of numbers.
#pragma once
#include <bit>
#include <cstdint>

namespace tetwarp {

/// Source: Fowler, Noll, Vo (FNV-1a, 64 bits), eight bytes at a time.
class NumberHash {
 public:
  void add(double number) { add_bits(std::bit_cast<std::uint64_t>(number)); }
  void add_bits(std::uint64_t bits) {
    value_ = (value_ ^ bits) * 0x100000001b3U;
    value_ ^= value_ >> 29;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace tetwarp
