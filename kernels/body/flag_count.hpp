/// @file flag_count.hpp
/// How many flags are set.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"

namespace tetwarp {

/// A number that the sums of executors add.
struct FlagCount {
  std::int64_t value = 0;

  TETWARP_HD FlagCount& operator+=(const FlagCount& other) {
    value += other.value;
    return *this;
  }
};

/// One index = one flag, 0 or 1.
struct FlagCountOp {
  View<const std::uint8_t> flags;

  TETWARP_HD FlagCount operator()(std::int64_t i) const { return {flags[i]}; }
};

}  // namespace tetwarp
