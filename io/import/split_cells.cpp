/// @file split_cells.cpp
/// Divides tetrahedra of ten nodes and repeats the rows of their arrays.
#include "io/import/split_cells.hpp"

#include <tuple>
#include <utility>

namespace tetwarp {

void split_curved_cells(ImportedMesh& mesh) {
  if (mesh.mid_nodes.empty()) return;
  const std::size_t cells = mesh.mesh.cell_count();
  const CurvedMesh curved = {std::move(mesh.mesh), std::exchange(mesh.mid_nodes, {})};
  mesh.mesh = split_curved(curved);
  constexpr std::size_t parts = std::tuple_size_v<decltype(parts_of_curved({}, {}))>;
  for (MeshArray& array : mesh.arrays) {
    if (!array.is_of_cells) continue;
    const auto row_size = static_cast<std::ptrdiff_t>(array.data.size() / cells);
    std::vector<std::byte> rows;
    for (std::size_t cell = 0; cell < cells; ++cell) {
      const auto row = array.data.begin() + static_cast<std::ptrdiff_t>(cell) * row_size;
      for (std::size_t part = 0; part < (is_curved(curved, cell) ? parts : 1); ++part) {
        rows.insert(rows.end(), row, row + row_size);
      }
    }
    array.data = std::move(rows);
  }
}

}  // namespace tetwarp
