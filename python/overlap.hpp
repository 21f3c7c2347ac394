/// @file overlap.hpp
/// Whether arrays share memory: outputs must not with what is read or with each other.
#pragma once
#include <algorithm>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "python/arrays.hpp"

namespace tetwarp::python {

/// Of arrays in C order.
bool overlap(const auto& one, const auto& other) {
  const auto bytes = [](const void* data) { return static_cast<const std::byte*>(data); };
  const std::byte* const first = bytes(one.data());
  const std::byte* const second = bytes(other.data());
  return first < second + other.nbytes() && second < first + one.nbytes();
}

bool overlaps_any(const auto& array, const auto& others) {
  return std::ranges::any_of(others, [&](const auto& other) { return overlap(array, other); });
}

/// The name of an output in messages.
inline std::string out_name(const std::vector<AnyOut>& outputs, std::size_t number) {
  return outputs.size() == 1 ? "out" : "out[" + std::to_string(number) + "]";
}

/// @throws std::invalid_argument  an output shares memory with a source or another output
inline void check_outputs(const std::vector<AnyOut>& outputs,
                          const std::vector<AnySamples>& sources) {
  for (std::size_t n = 0; n < outputs.size(); ++n) {
    if (overlaps_any(outputs[n], sources) ||
        overlaps_any(outputs[n], std::span(outputs).first(n))) {
      throw std::invalid_argument(out_name(outputs, n) +
                                  ": shares memory with a source or another output");
    }
  }
}

}  // namespace tetwarp::python
