/// @file from_index.hpp
/// FromIndex: a stage on a part of the indices of its body.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// Index 0 of the stage is index `first` of the body.
template <class Op>
struct FromIndex {
  Op op;
  std::int64_t first;

  TETWARP_HD void operator()(std::int64_t i) const { op(first + i); }
};

}  // namespace tetwarp
