/// @file mesh_vtk.cpp
/// Meshes in VTK's XML and legacy formats, read by VTK.
#include <vtkCellArray.h>
#include <vtkCellTypes.h>
#include <vtkDataArray.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <tetwarp/error.hpp>

#include "io/files/extension.hpp"
#include "io/reader/mesh_readers.hpp"
#include "io/reader/mesh_vtk_arrays.hpp"
#include "io/reader/vtk_error_notes.hpp"

namespace tetwarp {
namespace {
CellKind kind_of_type(int type) {
  const char* const name = vtkCellTypes::GetClassNameFromTypeId(type);
  const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  const int kept_nodes = type == VTK_TRIANGLE     ? 3
                         : type == VTK_TETRA      ? 4
                         : type == VTK_HEXAHEDRON ? 8
                                                  : 0;
  return {name, cell ? cell->GetCellDimension() : 3, kept_nodes};
}

/// Checks what VTK's readers take from files unchecked and its accessors rely on.
void check_cells(const std::string& path, vtkUnstructuredGrid& grid) {
  if (grid.GetNumberOfCells() == 0) return;
  vtkUnsignedCharArray* const types = grid.GetCellTypesArray();
  if (types == nullptr || types->GetNumberOfValues() != grid.GetNumberOfCells() ||
      !grid.GetCells()->IsValid()) {
    throw IoError(path, "",
                  "offsets, types and nodes of its cells contradict each other: damaged, write it "
                  "again");
  }
}

CellNumbers add_cells(const std::string& path, vtkUnstructuredGrid& grid, ImportedMesh& into) {
  check_cells(path, grid);
  CellNumbers numbers;
  std::map<int, CellKind> kinds;
  const vtkNew<vtkIdList> nodes;
  for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
    const int type = grid.GetCellType(c);
    if (!kinds.contains(type)) kinds[type] = kind_of_type(type);
    grid.GetCellPoints(c, nodes);
    const auto node_at = [&](std::size_t n) {
      const auto node = static_cast<vtkIdType>(n);
      const vtkIdType id = node < nodes->GetNumberOfIds() ? nodes->GetId(node) : -1;
      if (id >= 0 && id < grid.GetNumberOfPoints()) return id;
      throw IoError(path, "",
                    "cell " + std::to_string(c) + " does not have the nodes of a " +
                        kinds[type].name + ", each from 0 to " +
                        std::to_string(grid.GetNumberOfPoints() - 1) + ": damaged, write it again");
    };
    add_cell(path, kinds[type], c, node_at, into, numbers);
  }
  return numbers;
}

std::vector<std::string> array_names(vtkPointData& data) {
  std::vector<std::string> names;
  for (int a = 0; a < data.GetNumberOfArrays(); ++a) {
    const char* const name = data.GetArrayName(a);
    if (name != nullptr && data.GetArray(a) != nullptr) names.emplace_back(name);
  }
  return names;
}

std::vector<Point3> rows_of(vtkDataArray& array) {
  std::vector<Point3> rows(static_cast<std::size_t>(array.GetNumberOfTuples()));
  for (std::size_t row = 0; row < rows.size(); ++row) {
    array.GetTuple(static_cast<vtkIdType>(row), rows[row].data());
  }
  return rows;
}

void check_grid(const std::string& path, vtkUnstructuredGrid* grid) {
  if (grid != nullptr && grid->GetNumberOfPoints() > 0) return;
  throw IoError(path, "",
                "holds no unstructured grid that VTK can read: damaged, or of another kind");
}

/// Takes the mesh from the first step, and from every step its displacement if there is one.
/// @param number  of the step, which is its time where the file names none
void add_step(const std::string& path,
              vtkUnstructuredGrid& grid,
              int number,
              const MeshImportOptions& options,
              ImportedMesh& into) {
  vtkPointData& data = *grid.GetPointData();
  const auto name = choose_displacement(path, array_names(data), options);
  if (into.mesh.rest_positions.empty()) {
    into.mesh.rest_positions = rows_of(*grid.GetPoints()->GetData());
    const CellNumbers numbers = add_cells(path, grid, into);
    add_arrays(grid, name, numbers, into);
  }
  if (!name) return;
  vtkDataArray& array = *data.GetArray(name->c_str());
  if (array.GetNumberOfComponents() != 3 ||
      array.GetNumberOfTuples() != static_cast<vtkIdType>(into.mesh.rest_positions.size())) {
    throw IoError(path, *name, "expected three components for every node");
  }
  into.displacements.push_back(rows_of(array));
  into.times.push_back(time_of(grid).value_or(number));
}

/// VTK reads as many numbers as a file before version 5 declares, and beyond them where a cell goes
/// on behind the last one.
void check_declared(const std::string& path, vtkUnstructuredGrid& grid) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::getline(file, line);
  const std::string version = "Version ";
  const std::size_t at = line.find(version);
  if (at == std::string::npos || std::atof(line.c_str() + at + version.size()) >= 5) return;
  while (!line.starts_with("CELLS ") && std::getline(file, line)) {
  }
  long long cells = 0, numbers = 0;
  const bool is_found = std::sscanf(line.c_str(), "CELLS %lld %lld", &cells, &numbers) == 2;
  if (!is_found || grid.GetCells() == nullptr) return;
  const vtkIdType nodes = grid.GetCells()->GetNumberOfConnectivityIds();
  if (grid.GetNumberOfCells() == cells && nodes == numbers - cells) return;
  throw IoError(path, "",
                "has " + std::to_string(grid.GetNumberOfCells()) + " cells of " +
                    std::to_string(nodes) + " nodes, but declares 'CELLS " + std::to_string(cells) +
                    " " + std::to_string(numbers) + "': damaged, write it again");
}

/// Names lookup tables, of which VTK's reader keeps at most one: lines "LOOKUP_TABLE NAME SIZE".
void add_tables(const std::string& path, ImportedMesh& into) {
  std::ifstream file(path, std::ios::binary);
  for (std::string line; std::getline(file, line);) {
    char name[256] = {};
    long long size = 0;
    if (std::sscanf(line.c_str(), "LOOKUP_TABLE %255s %lld", name, &size) == 2) {
      into.left_out.push_back("lookup table '" + std::string(name) + "'");
    }
  }
}

ImportedMesh read_legacy(const std::string& path, const MeshImportOptions& options) {
  const vtkNew<vtkUnstructuredGridReader> reader;
  const VtkErrorNotes notes(*reader);
  reader->SetFileName(path.c_str());
  // Without these only the first array of a kind is read.
  reader->ReadAllScalarsOn();
  reader->ReadAllColorScalarsOn();
  reader->ReadAllVectorsOn();
  reader->ReadAllNormalsOn();
  reader->ReadAllTensorsOn();
  reader->ReadAllTCoordsOn();
  reader->ReadAllFieldsOn();
  if (reader->IsFileUnstructuredGrid() != 0) reader->Update();
  const bool is_good = reader->GetErrorCode() == 0 && !notes.has_error();
  check_grid(path, is_good ? reader->GetOutput() : nullptr);
  check_declared(path, *reader->GetOutput());
  ImportedMesh mesh;
  add_step(path, *reader->GetOutput(), 0, options, mesh);
  add_tables(path, mesh);
  return mesh;
}

/// VTK's reader does not pass on the attribute TimeValues: without the field TimeValue times are 0,
/// 1 and so on.
ImportedMesh read_xml(const std::string& path, const MeshImportOptions& options) {
  const vtkNew<vtkXMLUnstructuredGridReader> reader;
  const VtkErrorNotes notes(*reader);
  ImportedMesh mesh;
  if (reader->CanReadFile(path.c_str()) == 0) check_grid(path, nullptr);
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  const int steps = std::max(1, reader->GetNumberOfTimeSteps());
  for (int step = 0; step < steps; ++step) {
    if (steps > 1) reader->SetTimeStep(step);
    reader->Update();
    const bool is_good = reader->GetErrorCode() == 0 && !notes.has_error();
    check_grid(path, is_good ? reader->GetOutput() : nullptr);
    add_step(path, *reader->GetOutput(), step, options, mesh);
  }
  if (steps > 1 && !time_of(*reader->GetOutput())) {
    mesh.left_out.emplace_back("times of the steps, which are numbered from 0");
  }
  if (steps > 1 && mesh.arrays.size() > 1) {
    mesh.left_out.emplace_back("steps after the first of all arrays but the displacement");
  }
  return mesh;
}
}  // namespace

ImportedMesh read_vtk_mesh(const std::string& path, const MeshImportOptions& options) {
  return has_extension(path, ".vtu") ? read_xml(path, options) : read_legacy(path, options);
}

}  // namespace tetwarp
