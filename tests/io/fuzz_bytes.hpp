/// @file fuzz_bytes.hpp
/// Damage to files as bytes and as text.
#pragma once
#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/io/fuzz_values.hpp"

namespace tetwarp::test {

/// Changes, cuts, repeats or removes a few bytes.
inline void damage_bytes(std::string& bytes, Random& random) {
  for (std::uint64_t changes = 1 + random.below(8); changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = random.below(bytes.size());
    const std::size_t length = 1 + random.below(std::min<std::size_t>(64, bytes.size() - at));
    switch (random.below(8)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.replace(at, length, length, random.below(2) == 0 ? '\0' : '\xff');
        break;
      default:
        bytes[at] = static_cast<char>(random.below(256));
    }
  }
}

/// Replaces a few numbers in a text by others that are likely to break a reader.
inline void damage_numbers(std::string& text, Random& random) {
  constexpr std::array numbers = {"0",          "-1",         "1",
                                  "2",          "3",          "7",
                                  "255",        "65536",      "2147483647",
                                  "2147483648", "4294967295", "-2147483648",
                                  "1000000000", "1e300",      "nan",
                                  "inf",        "0.5",        "9223372036854775807",
                                  "",           "x",          "18446744073709551615"};
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  for (std::uint64_t changes = 1 + random.below(3); changes > 0; --changes) {
    const auto from = text.begin() + static_cast<std::ptrdiff_t>(random.below(text.size() + 1));
    const auto begin = std::find_if(from, text.end(), is_digit);
    const auto end = std::find_if_not(begin, text.end(), is_digit);
    text.replace(begin, end, numbers[random.below(numbers.size())]);
  }
}

}  // namespace tetwarp::test
