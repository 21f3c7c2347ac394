/// @file five_tets.hpp
/// The division of a box into five tetrahedra.
#pragma once

namespace tetwarp {

/// The five tetrahedra of a cell and of its mirror image, which divide the face between them along
/// the same diagonal; all have positive volume. Bits 1, 2 and 4 of a corner: at the far end of axis
/// 0, 1, 2. Cell (a, b, c) of a lattice has those of index (a + b + c) % 2.
inline constexpr int tets_of_cell[2][5][4] = {
    {{0, 5, 3, 6}, {1, 0, 5, 3}, {2, 0, 3, 6}, {4, 0, 6, 5}, {7, 6, 3, 5}},
    {{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 2, 1, 7}, {5, 1, 4, 7}, {6, 4, 2, 7}}};

}  // namespace tetwarp
