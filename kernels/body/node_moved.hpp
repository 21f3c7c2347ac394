/// @file node_moved.hpp
/// Marks the nodes whose positions have other bits than at the previous step.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"

namespace tetwarp {

/// One index = one node.
struct NodeMovedOp {
  View<const double> position;   ///< [nodes][3]
  View<double> previous;         ///< in, out: becomes `position`
  View<std::uint8_t> has_moved;  ///< out

  TETWARP_HD void operator()(std::int64_t n) const {
    bool moves = false;
    for (std::int64_t k = 3 * n; k < 3 * n + 3; ++k) {
      moves |= !(position[k] == previous[k]);  // true for NaN, as `previous` is at first
      previous[k] = position[k];
    }
    has_moved[n] = moves;
  }
};

/// One index = one number: sets it.
struct FillNumbersOp {
  double value;
  View<double> to;

  TETWARP_HD void operator()(std::int64_t i) const { to[i] = value; }
};

}  // namespace tetwarp
