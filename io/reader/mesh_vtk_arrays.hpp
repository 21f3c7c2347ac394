/// @file mesh_vtk_arrays.hpp
/// Arrays of VTK's grids.
#pragma once
#include <optional>
#include <string>

#include "io/volume/mesh_arrays.hpp"

class vtkDataArray;
class vtkUnstructuredGrid;

namespace tetwarp {

/// The type of the numbers of an array; nothing of arrays of bits.
std::optional<PixelType> vtk_pixel_type(vtkDataArray& array);

/// Adds the arrays of points and kept cells, and the numbers of the cells; names arrays that cannot
/// be kept.
/// @param displacement  name of the point array that is kept as displacement
void add_arrays(vtkUnstructuredGrid& grid,
                const std::optional<std::string>& displacement,
                const CellNumbers& cells,
                ImportedMesh& into);

/// The time of a step, which VTK and ParaView write as field array `TimeValue`.
std::optional<double> time_of(vtkUnstructuredGrid& grid);

}  // namespace tetwarp
