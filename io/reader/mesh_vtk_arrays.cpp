/// @file mesh_vtk_arrays.cpp
/// Copies VTK's arrays, as far as their types are known.
#include "io/reader/mesh_vtk_arrays.hpp"

#include <vtkAbstractArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

namespace tetwarp {

std::optional<PixelType> vtk_pixel_type(vtkDataArray& array) {
  const int type = array.GetDataType();
  if (type == VTK_FLOAT) return PixelType::float32;
  if (type == VTK_DOUBLE) return PixelType::float64;
  const bool is_signed = array.GetDataTypeMin() < 0;
  switch (array.GetDataTypeSize()) {
    case 1:
      return is_signed ? PixelType::int8 : PixelType::uint8;
    case 2:
      return is_signed ? PixelType::int16 : PixelType::uint16;
    case 4:
      return is_signed ? PixelType::int32 : PixelType::uint32;
    case 8:
      return is_signed ? PixelType::int64 : PixelType::uint64;
    default:
      return std::nullopt;
  }
}

namespace {
/// The given rows of an array; nothing when a VTKHDF file cannot hold it.
std::optional<MeshArray> rows_of(vtkDataArray* array,
                                 const std::string& name,
                                 bool is_of_cells,
                                 vtkIdType tuples,
                                 const std::vector<std::int64_t>& rows) {
  if (array == nullptr || array->GetNumberOfTuples() != tuples || !is_free_name(name)) return {};
  const std::optional<PixelType> type = vtk_pixel_type(*array);
  const int components = array->GetNumberOfComponents();
  if (!type || components < 1 || components > 9) return {};
  MeshArray kept{name, is_of_cells, *type, components, {}};
  const std::size_t bytes = size_of(*type) * static_cast<std::size_t>(components);
  kept.data.resize(rows.size() * bytes);
  const auto* const in = static_cast<const std::byte*>(array->GetVoidPointer(0));
  for (std::size_t row = 0; row < rows.size(); ++row) {
    std::memcpy(kept.data.data() + row * bytes, in + static_cast<std::size_t>(rows[row]) * bytes,
                bytes);
  }
  return kept;
}

void add_group(vtkFieldData& data,
               bool is_of_cells,
               vtkIdType tuples,
               const std::vector<std::int64_t>& rows,
               const std::optional<std::string>& displacement,
               ImportedMesh& into) {
  for (int a = 0; a < data.GetNumberOfArrays(); ++a) {
    const char* const given = data.GetArrayName(a);
    const std::string name = given == nullptr ? "" : given;
    const std::string noun = (is_of_cells ? "cell array '" : "point array '") + name + "'";
    vtkAbstractArray* const array = data.GetAbstractArray(a);
    if (array->HasAComponentName()) into.left_out.push_back("names of the components of " + noun);
    if (!is_of_cells && name == displacement) continue;
    if (auto kept = rows_of(data.GetArray(a), name, is_of_cells, tuples, rows)) {
      into.arrays.push_back(std::move(*kept));
    } else {
      into.left_out.push_back(noun);
    }
  }
}
constexpr const char* time_field = "TimeValue";
}  // namespace

std::optional<double> time_of(vtkUnstructuredGrid& grid) {
  vtkDataArray* const array = grid.GetFieldData()->GetArray(time_field);
  if (array == nullptr || array->GetNumberOfValues() != 1) return std::nullopt;
  const double time = array->GetComponent(0, 0);
  return std::isfinite(time) ? std::optional(time) : std::nullopt;
}

void add_arrays(vtkUnstructuredGrid& grid,
                const std::optional<std::string>& displacement,
                const CellNumbers& cells,
                ImportedMesh& into) {
  std::vector<std::int64_t> nodes(static_cast<std::size_t>(grid.GetNumberOfPoints()));
  std::iota(nodes.begin(), nodes.end(), 0);
  add_group(*grid.GetPointData(), false, grid.GetNumberOfPoints(), nodes, displacement, into);
  add_group(*grid.GetCellData(), true, grid.GetNumberOfCells(), cells.all(), {}, into);
  add_numbers("original_cell", true, cells.all(), into);
  vtkFieldData& fields = *grid.GetFieldData();
  for (int a = 0; a < fields.GetNumberOfArrays(); ++a) {
    const char* const name = fields.GetArrayName(a);
    if (displacement && time_of(grid) && std::string(name) == time_field) continue;
    into.left_out.push_back("field array '" + std::string(name == nullptr ? "" : name) + "'");
  }
}

}  // namespace tetwarp
