/// @file number_hash.hpp
/// Hashes of words and numbers. Not cryptographic.
#pragma once
#include <bit>
#include <cstdint>

namespace tetwarp {

/// FNV-1a with its 64-bit constants, over 64-bit words instead of bytes for speed, with a shift
/// after each multiplication that mixes high bits into low ones. Source: Fowler, Noll, Vo.
template <int shift>
class WordHash {
 public:
  void add(double number) { add_bits(std::bit_cast<std::uint64_t>(number)); }
  void add_bits(std::uint64_t bits) {
    value_ = (value_ ^ bits) * 0x100000001b3U;
    value_ ^= value_ >> shift;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

using NumberHash = WordHash<29>;

}  // namespace tetwarp
