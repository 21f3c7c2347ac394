/// @file system_pattern.hpp
/// Which 3x3 blocks the system of a Model has and what adds to each; made once per scene.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/model/model.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

/// ItemLists that owns its arrays.
struct ItemArrays {
  std::vector<std::int32_t> start;
  std::vector<std::uint32_t> item;
};
struct ElementArrays {
  ItemArrays blocks, rows;
};

/// SystemRows that owns its arrays.
struct SystemPattern {
  std::int32_t row_count = 0, unknown_count = 0;
  std::vector<std::int32_t> block_of, row_of;  ///< of rows, of blocks
  std::vector<std::int32_t> start, free_end, column, diagonal;
  std::vector<std::uint8_t> pair;
  std::vector<UpperBlock> upper;
  ElementArrays tets, edges, springs;
  std::vector<std::int32_t> scalar_start;

  std::vector<std::int32_t> island_start;  ///< [islands + 1] rows of each island
};

/// @throws std::invalid_argument  the model has more elements or blocks than 32-bit places allow,
///                                indices out of range, or unknowns that belong to no island
SystemPattern make_system_pattern(const Model& model);

/// Views of its arrays, without the lists of what adds to a block.
SystemRows rows_of(const SystemPattern& pattern);

}  // namespace tetwarp
