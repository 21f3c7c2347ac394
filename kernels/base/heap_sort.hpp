/// @file heap_sort.hpp
/// Sorts a few values in place: one index of a stage, without memory of its own.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// Ascending. Source: Williams 1964, with Floyd's construction of the heap.
/// @param less  a strict order in which no two of the values are equal
template <class T, class Less>
TETWARP_ANY_EXEC void heap_sort(T* values, std::int64_t count, const Less& less) {
  const auto sift = [&](std::int64_t parent, std::int64_t end) {
    const T value = values[parent];
    for (std::int64_t child = 2 * parent + 1; child < end; child = 2 * parent + 1) {
      if (child + 1 < end && less(values[child], values[child + 1])) ++child;
      if (!less(value, values[child])) break;
      values[parent] = values[child];
      parent = child;
    }
    values[parent] = value;
  };
  for (std::int64_t parent = count / 2 - 1; parent >= 0; --parent) sift(parent, count);
  for (std::int64_t end = count - 1; end > 0; --end) {
    const T last = values[end];
    values[end] = values[0];
    values[0] = last;
    sift(0, end);
  }
}

}  // namespace tetwarp
