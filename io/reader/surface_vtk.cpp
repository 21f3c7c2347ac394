/// @file surface_vtk.cpp
/// Triangles of surfaces and of unstructured grids, read by VTK.
#include <vtkCellData.h>
#include <vtkCellTypes.h>
#include <vtkFieldData.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <string>
#include <tetwarp/error.hpp>

#include "io/reader/mesh_readers.hpp"
#include "io/reader/surface_seams.hpp"
#include "io/reader/vtk_point_set.hpp"

namespace tetwarp {
namespace {
/// Cells of two dimensions as triangles; all others are counted.
void add_triangles(const std::string& path, vtkPointSet& set, ImportedMesh& into) {
  const vtkNew<vtkGenericCell> cell;
  const vtkNew<vtkIdList> nodes, corners;
  const vtkNew<vtkPoints> places;
  for (vtkIdType c = 0; c < set.GetNumberOfCells(); ++c) {
    set.GetCellPoints(c, nodes);
    for (vtkIdType n = 0; n < nodes->GetNumberOfIds(); ++n) {
      if (nodes->GetId(n) >= 0 && nodes->GetId(n) < set.GetNumberOfPoints()) continue;
      throw IoError(path, "",
                    "cell " + std::to_string(c) + " refers to a point that is not there: damaged");
    }
    set.GetCell(c, cell);
    if (cell->GetCellDimension() != 2) {
      ++into.skipped[vtkCellTypes::GetClassNameFromTypeId(set.GetCellType(c))];
      continue;
    }
    if (cell->Triangulate(0, corners, places) == 0) {
      throw IoError(path, "",
                    "cell " + std::to_string(c) +
                        " cannot be divided into triangles; triangulate the surface");
    }
    for (vtkIdType n = 0; n + 2 < corners->GetNumberOfIds(); n += 3) {
      into.triangles.push_back({static_cast<std::int32_t>(corners->GetId(n)),
                                static_cast<std::int32_t>(corners->GetId(n + 1)),
                                static_cast<std::int32_t>(corners->GetId(n + 2))});
    }
  }
}

void add_array_names(vtkFieldData& data, const std::string& noun, ImportedMesh& into) {
  for (int a = 0; a < data.GetNumberOfArrays(); ++a) {
    const char* const name = data.GetArrayName(a);
    into.left_out.push_back(noun + " array '" + (name == nullptr ? "" : name) + "'");
  }
}
}  // namespace

ImportedMesh read_vtk_surface(const std::string& path, const MeshImportOptions&) {
  const vtkSmartPointer<vtkPointSet> set = read_vtk_point_set(path);
  ImportedMesh mesh;
  mesh.mesh.rest_positions.resize(static_cast<std::size_t>(set->GetNumberOfPoints()));
  for (std::size_t p = 0; p < mesh.mesh.rest_positions.size(); ++p) {
    set->GetPoint(static_cast<vtkIdType>(p), mesh.mesh.rest_positions[p].data());
  }
  add_triangles(path, *set, mesh);
  add_array_names(*set->GetPointData(), "point", mesh);
  add_array_names(*set->GetCellData(), "cell", mesh);
  add_array_names(*set->GetFieldData(), "field", mesh);
  if (vtkPolyData::SafeDownCast(set) != nullptr) {
    join_seams(mesh.mesh.rest_positions, mesh.triangles);
  }
  return mesh;
}

}  // namespace tetwarp
