/// @file split_cells.hpp
/// Straight tetrahedra in place of those of ten nodes.
#pragma once
#include <tetwarp/mesh_import.hpp>

namespace tetwarp {

/// Puts eight tetrahedra, each with the rows of its arrays, in the place of one of ten nodes.
/// @pre check_imported() has passed
void split_curved_cells(ImportedMesh& mesh);

}  // namespace tetwarp
