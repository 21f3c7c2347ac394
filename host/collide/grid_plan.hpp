/// @file grid_plan.hpp
/// Which grids the broad phase uses: sizes of cells from the sizes of boxes.
#pragma once
#include <array>
#include <cstdint>

#include "kernels/collide/item_cells.hpp"

namespace tetwarp {

/// Divides the sizes of items among grids so that the estimated work is least: few entries for
/// large boxes, few boxes in one cell. The cells of a grid are 1.3 times its mean box; no box has
/// more than 9 cells along an axis of its own grid.
/// @param counts   items of each size
/// @param largest  size 0 is that of boxes from 2^largest to 2^(largest + 1) [m]
/// @param space    holds all boxes
GridPlan make_grid_plan(const std::array<std::int64_t, item_sizes>& counts,
                        int largest,
                        const Box& space);

}  // namespace tetwarp
