/// @file group_range.hpp
/// Successive contacts of a list that are of one group.
#pragma once
#include <cstddef>
#include <cstdint>

namespace tetwarp {

/// Contacts [begin, end) of a list; impulses are listed in the same order.
struct GroupRange {
  std::int32_t group = 0;
  std::size_t begin = 0, end = 0;
  int passes = 1;  ///< over these contacts in one sweep

  std::size_t size() const { return end - begin; }
};

}  // namespace tetwarp
