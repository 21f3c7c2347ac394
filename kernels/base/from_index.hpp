/// @file from_index.hpp
/// FromIndex: a stage on a part of the indices of its body.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// Index 0 of the stage is index `first` of the body.
template <class Body>
struct FromIndex {
  Body body;
  std::int64_t first;

  TETWARP_HD void operator()(std::int64_t i) const { body(first + i); }
};

}  // namespace tetwarp
