/// @file vtk_steps.cpp
/// Cells, points and arrays of VTK's grids, each checked before it is read.
#include "io/reader/vtk_steps.hpp"

#include <vtkCellArray.h>
#include <vtkCellTypes.h>
#include <vtkDataArray.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <map>
#include <tetwarp/error.hpp>
#include <utility>

#include "io/reader/mesh_readers.hpp"
#include "io/reader/mesh_vtk_arrays.hpp"

namespace tetwarp {
namespace {
CellShape shape_of_type(int type) {
  switch (type) {
    case VTK_TRIANGLE:
      return CellShape::triangle;
    case VTK_TETRA:
      return CellShape::tetrahedron;
    case VTK_QUADRATIC_TETRA:
      return CellShape::curved_tetrahedron;
    case VTK_HEXAHEDRON:
      return CellShape::hexahedron;
    case VTK_VOXEL:
      return CellShape::voxel;
    case VTK_WEDGE:
      return CellShape::wedge;
    case VTK_PYRAMID:
      return CellShape::pyramid;
    default:
      return CellShape::other;
  }
}

CellKind kind_of_type(int type) {
  const char* const name = vtkCellTypes::GetClassNameFromTypeId(type);
  const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  return {name, cell ? cell->GetCellDimension() : 3, shape_of_type(type)};
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

/// Type and nodes of every cell, one after the other.
std::vector<std::int64_t> cell_words(vtkUnstructuredGrid& grid) {
  std::vector<std::int64_t> words;
  const vtkNew<vtkIdList> nodes;
  for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
    words.push_back(grid.GetCellType(c));
    grid.GetCellPoints(c, nodes);
    for (vtkIdType n = 0; n < nodes->GetNumberOfIds(); ++n) words.push_back(nodes->GetId(n));
  }
  return words;
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
}  // namespace

void check_grid(const std::string& path, vtkUnstructuredGrid* grid) {
  if (grid != nullptr && grid->GetNumberOfPoints() > 0) return;
  throw IoError(path, "",
                "holds no unstructured grid that VTK can read: damaged, or of another kind");
}

void VtkSteps::start(const std::string& file, vtkUnstructuredGrid& grid) {
  file_ = file;
  displacement_ = choose_displacement(file, array_names(*grid.GetPointData()), options_);
  mesh_.mesh.rest_positions = rows_of(*grid.GetPoints()->GetData());
  const CellNumbers numbers = add_cells(file, grid, mesh_);
  nodes_of_cells_ = cell_words(grid);
  add_arrays(grid, displacement_, numbers, mesh_);
}

void VtkSteps::check_same_mesh(const std::string& file,
                               vtkUnstructuredGrid& grid,
                               bool has_cells) const {
  if (grid.GetNumberOfPoints() != static_cast<vtkIdType>(mesh_.mesh.rest_positions.size()) ||
      (has_cells && count_ > 0 && cell_words(grid) != nodes_of_cells_)) {
    throw IoError(
        file, "",
        "step " + std::to_string(count_) +
            " has other points or cells than the first one; all steps must have one mesh");
  }
}

void VtkSteps::add(const std::string& file, vtkUnstructuredGrid& grid, std::optional<double> time) {
  check_grid(file, &grid);
  // Of later steps in one file VTK's reader for XML gives only what changes.
  const bool has_cells = count_ == 0 || file != file_;
  if (has_cells) check_cells(file, grid);
  const std::optional<double> own = time_of(grid);
  is_timed_ = is_timed_ && (own || time);
  const double number = count_;
  if (count_ == 0) start(file, grid);
  check_same_mesh(file, grid, has_cells);
  ++count_;
  const std::vector<Point3>& rest = mesh_.mesh.rest_positions;
  std::vector<Point3> rows = rows_of(*grid.GetPoints()->GetData());
  moves_ = moves_ || rows != rest;
  if (displacement_) {
    vtkDataArray* const array = grid.GetPointData()->GetArray(displacement_->c_str());
    if (array == nullptr || array->GetNumberOfComponents() != 3 ||
        array->GetNumberOfTuples() != static_cast<vtkIdType>(rest.size())) {
      throw IoError(file, *displacement_, "expected three components for every node");
    }
    rows = rows_of(*array);
  } else {
    for (std::size_t node = 0; node < rows.size(); ++node) {
      for (std::size_t axis = 0; axis < 3; ++axis) rows[node][axis] -= rest[node][axis];
    }
  }
  mesh_.displacements.push_back(std::move(rows));
  mesh_.times.push_back(own ? *own : time.value_or(number));
}

ImportedMesh VtkSteps::take() {
  if (!displacement_ && moves_) {
    mesh_.moves_points = true;
  } else if (!displacement_) {
    mesh_.displacements.clear();
    mesh_.times.clear();
  } else if (moves_) {
    mesh_.left_out.emplace_back("points of later steps, which move beside the displacement");
  }
  if (count_ > 1 && !is_timed_) {
    mesh_.left_out.emplace_back("times of the steps, which are numbered from 0");
  }
  if (count_ > 1 && mesh_.arrays.size() > 1) {
    mesh_.left_out.emplace_back("steps after the first of all arrays but the displacement");
  }
  return std::move(mesh_);
}

}  // namespace tetwarp
