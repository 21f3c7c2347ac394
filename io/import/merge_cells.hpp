/// @file merge_cells.hpp
/// Cells that an imported file holds twice.
#pragma once
#include <tetwarp/mesh_import.hpp>

namespace tetwarp {

/// Keeps of cells with nodes at the same places the first, with the rows of its arrays. It gets the
/// groups of all of them; see group_name().
/// @pre check_imported() has passed
void merge_cells(ImportedMesh& mesh);

}  // namespace tetwarp
