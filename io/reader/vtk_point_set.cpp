/// @file vtk_point_set.cpp
/// The reader of each format, and copies with other points.
#include "io/reader/vtk_point_set.hpp"

#include <vtkDataSetReader.h>
#include <vtkDataSetWriter.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkOBJWriter.h>
#include <vtkPLYReader.h>
#include <vtkPLYWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkSTLWriter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLReader.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <array>
#include <fstream>
#include <string>
#include <tetwarp/error.hpp>
#include <type_traits>
#include <vector>

#include "io/files/extension.hpp"
#include "io/reader/mesh_readers.hpp"
#include "io/reader/vtk_error_notes.hpp"

namespace tetwarp {
namespace {
/// Reads a file. @throws IoError when there is nothing that VTK can read
template <class Reader>
vtkSmartPointer<vtkPointSet> output_of(const std::string& path, Reader& reader) {
  const VtkErrorNotes notes(reader);
  reader.SetFileName(path.c_str());
  if constexpr (std::is_base_of_v<vtkXMLReader, Reader>) {
    reader.UpdateInformation();
    if (reader.GetNumberOfTimeSteps() > 1) {
      throw IoError(path, "",
                    "has " + std::to_string(reader.GetNumberOfTimeSteps()) +
                        " steps, of which one would be read; write a file of each, or VTKHDF");
    }
  }
  reader.Update();
  vtkPointSet* const output = vtkPointSet::SafeDownCast(reader.GetOutputDataObject(0));
  if (reader.GetErrorCode() == 0 && !notes.has_error() && output != nullptr &&
      output->GetNumberOfPoints() > 0) {
    return output;
  }
  throw IoError(path, "", "holds no surface that VTK can read: damaged, or of another kind");
}

}  // namespace

vtkSmartPointer<vtkPointSet> read_vtk_point_set(const std::string& path) {
  if (has_extension(path, ".stl")) {
    const vtkNew<vtkSTLReader> reader;
    reader->MergingOff();
    return output_of(path, *reader);
  }
  if (has_extension(path, ".ply")) return output_of(path, *vtkNew<vtkPLYReader>());
  if (has_extension(path, ".obj")) return output_of(path, *vtkNew<vtkOBJReader>());
  if (has_extension(path, ".vtp")) return output_of(path, *vtkNew<vtkXMLPolyDataReader>());
  if (has_extension(path, ".vtu")) return output_of(path, *vtkNew<vtkXMLUnstructuredGridReader>());
  if (!has_extension(path, ".vtk")) {
    throw IoError(
        path, "",
        "is no file of a single surface: series and blocks are not read as surfaces; name "
        "one of their files, or write VTKHDF");
  }
  return output_of(path, *vtkNew<vtkDataSetReader>());
}

namespace {
/// Writes a file. @throws IoError when VTK reports an error
template <class Writer>
void write_by(Writer& writer, vtkPointSet& set, const std::string& output) {
  const VtkErrorNotes notes(writer);
  writer.SetFileName(output.c_str());
  writer.SetInputData(&set);
  const bool is_written = writer.Write() != 0;
  if (is_written && writer.GetErrorCode() == 0 && !notes.has_error()) return;
  throw IoError(output, "", "cannot be written by VTK: the folder may be full");
}

template <class Writer>
void write_binary(vtkPointSet& set, const std::string& output) {
  const vtkNew<Writer> writer;
  writer->SetFileTypeToBinary();
  write_by(*writer, set, output);
}

template <class Wanted>
Wanted& cast_to(const std::string& path, vtkPointSet& set, const std::string& kind) {
  Wanted* const cast = Wanted::SafeDownCast(&set);
  if (cast == nullptr) {
    throw IoError(path, "", "holds other cells than " + kind + " can have; write .vtk");
  }
  return *cast;
}

void write_point_set(const std::string& path, vtkPointSet& set, const std::string& output) {
  if (has_extension(output, ".vtk")) return write_binary<vtkDataSetWriter>(set, output);
  if (has_extension(output, ".vtu")) {
    return write_by(*vtkNew<vtkXMLUnstructuredGridWriter>(),
                    cast_to<vtkUnstructuredGrid>(path, set, "a .vtu"), output);
  }
  vtkPolyData& surface = cast_to<vtkPolyData>(path, set, "a surface");
  if (has_extension(output, ".vtp")) {
    return write_by(*vtkNew<vtkXMLPolyDataWriter>(), surface, output);
  }
  if (has_extension(output, ".stl")) return write_binary<vtkSTLWriter>(surface, output);
  if (has_extension(output, ".ply")) return write_binary<vtkPLYWriter>(surface, output);
  write_by(*vtkNew<vtkOBJWriter>(), surface, output);
}
}  // namespace

std::vector<Point3> read_vtk_points(const std::string& path) {
  const vtkSmartPointer<vtkPointSet> set = read_vtk_point_set(path);
  std::vector<Point3> points(static_cast<std::size_t>(set->GetNumberOfPoints()));
  for (std::size_t p = 0; p < points.size(); ++p) {
    set->GetPoint(static_cast<vtkIdType>(p), points[p].data());
  }
  return points;
}

void place_vtk_points(const std::string& path,
                      const std::string& numbers,
                      const std::string& output) {
  const vtkSmartPointer<vtkPointSet> set = read_vtk_point_set(path);
  const vtkIdType count = set->GetNumberOfPoints();
  std::ifstream in(numbers, std::ios::binary);
  const vtkNew<vtkPoints> points;  // of float32 where they were, which the formats of surfaces have
  points->SetDataType(set->GetPoints()->GetDataType());
  points->SetNumberOfPoints(count);
  for (vtkIdType p = 0; p < count; ++p) {
    Point3 x{};
    in.read(reinterpret_cast<char*>(x.data()), sizeof x);
    points->SetPoint(p, x.data());
  }
  const vtkNew<vtkUnsignedCharArray> inside;
  inside->SetName("inside");
  inside->SetNumberOfValues(count);
  in.read(reinterpret_cast<char*>(inside->GetPointer(0)), count);
  if (!in) throw IoError(path, "", "has changed since it was read");
  set->SetPoints(points);
  set->GetPointData()->AddArray(inside);
  write_point_set(path, *set, output);
}

}  // namespace tetwarp
