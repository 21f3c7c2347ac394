/// @file system_blocks.hpp
/// Rows of the system of a step as rows of a BlockLu, which numbers them from another first row.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/step/cpu/block_lu.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

/// Appends the blocks off the diagonal between unknowns.
/// @param place  row of the system
/// @param row    its number in the BlockLu; columns are numbered with the same difference
void list_system_row(const SystemRows& rows,
                     std::int32_t place,
                     std::int32_t row,
                     std::vector<BlockLu::Entry>& entries);

/// Adds all blocks between unknowns of the row. @param values  of the system, column by column
void add_system_row(const SystemRows& rows,
                    View<const double> values,
                    std::int32_t place,
                    std::int32_t row,
                    BlockLu& lu);

}  // namespace tetwarp
