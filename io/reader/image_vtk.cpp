/// @file image_vtk.cpp
/// Images of VTK's XML format (.vti), with all their point arrays.
#include <vtkAbstractArray.h>
#include <vtkBitArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLImageDataReader.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <tetwarp/error.hpp>

#include "io/reader/image_readers.hpp"
#include "io/reader/mesh_vtk_arrays.hpp"
#include "io/reader/vtk_error_notes.hpp"

namespace tetwarp {
namespace {
vtkSmartPointer<vtkImageData> read_image(const std::string& path) {
  const vtkNew<vtkXMLImageDataReader> reader;
  const VtkErrorNotes notes(*reader);
  reader->SetFileName(path.c_str());
  reader->Update();
  if (reader->GetErrorCode() != 0 || notes.has_error() || reader->GetOutput() == nullptr) {
    throw IoError(path, "", "is no image that VTK can read: damaged, or of another version");
  }
  return reader->GetOutput();
}

Grid grid_of(const std::string& path, vtkImageData& image) {
  Grid grid;
  int extent[6];
  image.GetExtent(extent);
  Point3 start{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.dims[axis] = std::int64_t{extent[2 * axis + 1]} - extent[2 * axis] + 1;
    grid.origin[axis] = image.GetOrigin()[axis];
    grid.spacing[axis] = image.GetSpacing()[axis];
    start[axis] = extent[2 * axis];
  }
  for (std::size_t n = 0; n < 9; ++n) {
    grid.direction[n] = image.GetDirectionMatrix()->GetData()[n];
  }
  try {
    check_grid(grid, "grid");
    grid.origin = grid.world_of(start);
    check_grid(grid, "grid");
  } catch (const std::invalid_argument& error) {
    throw IoError(
        path, "",
        std::string(error.what()) + "; correct WholeExtent, Origin, Spacing or Direction");
  }
  return grid;
}

/// Type of samples as they are read: bits as uint8. Nothing for arrays that are not read.
std::optional<PixelType> sample_type(vtkImageData& image, vtkDataArray* array) {
  if (array == nullptr || array->GetNumberOfTuples() != image.GetNumberOfPoints()) return {};
  if (array->GetNumberOfComponents() < 1 || array->GetNumberOfComponents() > 9) return {};
  if (array->GetDataType() == VTK_BIT) return PixelType::uint8;
  return vtk_pixel_type(*array);
}

std::string text_of(const char* text) {
  return text == nullptr ? "" : text;
}

void add_names(vtkFieldData& data, const std::string& group, std::vector<std::string>& names) {
  for (int a = 0; a < data.GetNumberOfArrays(); ++a) {
    names.push_back(group + "/" + text_of(data.GetArrayName(a)));
  }
}

ForeignImage vtk_image_of(const std::string& path, vtkImageData& data) {
  ForeignImage image;
  image.grid = grid_of(path, data);
  vtkPointData& points = *data.GetPointData();
  for (int a = 0; a < points.GetNumberOfArrays(); ++a) {
    const std::string name = text_of(points.GetArrayName(a));
    vtkDataArray* const array = points.GetArray(a);
    const std::optional<PixelType> type = sample_type(data, array);
    if (type && !name.empty()) {
      image.arrays.push_back({name, *type, array->GetNumberOfComponents()});
      if (array == points.GetScalars() || image.active.empty()) image.active = name;
    } else {
      image.not_read.push_back("PointData/" + name);
    }
  }
  add_names(*data.GetCellData(), "CellData", image.not_read);
  add_names(*data.GetFieldData(), "FieldData", image.not_read);
  return image;
}
}  // namespace

ForeignImage read_vtk_image(const std::string& path) {
  return vtk_image_of(path, *read_image(path));
}

void read_vtk_samples(const std::string& path,
                      const std::string& name,
                      const TakeImage& take_image,
                      const TakeSlice& take) {
  const vtkSmartPointer<vtkImageData> data = read_image(path);
  const ForeignImage image = vtk_image_of(path, *data);
  take_image(image);
  const Grid& grid = image.grid;
  vtkDataArray* const array = data->GetPointData()->GetArray(name.c_str());
  const std::optional<PixelType> type = sample_type(*data, array);
  if (!type) throw IoError(path, name, "no such array");
  const std::int64_t values = grid.dims[0] * grid.dims[1] * array->GetNumberOfComponents();
  const std::size_t bytes = static_cast<std::size_t>(values) * size_of(*type);
  auto* const bits = vtkBitArray::SafeDownCast(array);
  std::vector<std::uint8_t> slice(bits == nullptr ? 0 : bytes);
  for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
    for (std::size_t n = 0; n < slice.size(); ++n) {
      slice[n] = static_cast<std::uint8_t>(bits->GetValue(k * values + static_cast<vtkIdType>(n)));
    }
    const auto* const samples = static_cast<const std::byte*>(array->GetVoidPointer(0));
    take(bits == nullptr ? samples + static_cast<std::size_t>(k) * bytes
                         : reinterpret_cast<const std::byte*>(slice.data()),
         bytes);
  }
}

}  // namespace tetwarp
