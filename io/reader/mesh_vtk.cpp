/// @file mesh_vtk.cpp
/// Meshes in VTK's XML and legacy formats and in Exodus files, read by VTK.
#include <vtkAppendFilter.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCompositeDataIterator.h>
#include <vtkExodusIIReader.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkXMLMultiBlockDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <tetwarp/error.hpp>
#include <utility>

#include "io/files/extension.hpp"
#include "io/files/numbered_files.hpp"
#include "io/reader/mesh_readers.hpp"
#include "io/reader/vtk_error_notes.hpp"
#include "io/reader/vtk_file_list.hpp"
#include "io/reader/vtk_steps.hpp"

namespace tetwarp {
namespace {
using GridPointer = vtkSmartPointer<vtkUnstructuredGrid>;

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

GridPointer read_legacy_grid(const std::string& path) {
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
  return reader->GetOutput();
}

/// VTK's reader does not pass on the attribute TimeValues: without the field TimeValue times are 0,
/// 1 and so on.
void add_xml(const std::string& path, VtkSteps& into) {
  const vtkNew<vtkXMLUnstructuredGridReader> reader;
  const VtkErrorNotes notes(*reader);
  if (reader->CanReadFile(path.c_str()) == 0) check_grid(path, nullptr);
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  const int steps = std::max(1, reader->GetNumberOfTimeSteps());
  for (int step = 0; step < steps; ++step) {
    if (steps > 1) reader->SetTimeStep(step);
    reader->Update();
    const bool is_good = reader->GetErrorCode() == 0 && !notes.has_error();
    check_grid(path, is_good ? reader->GetOutput() : nullptr);
    into.add(path, *reader->GetOutput(), std::nullopt);
  }
}

/// The first step of a .vtu file.
GridPointer read_xml_grid(const std::string& path) {
  const vtkNew<vtkXMLUnstructuredGridReader> reader;
  const VtkErrorNotes notes(*reader);
  if (reader->CanReadFile(path.c_str()) == 0) check_grid(path, nullptr);
  reader->SetFileName(path.c_str());
  reader->Update();
  const bool is_good = reader->GetErrorCode() == 0 && !notes.has_error();
  check_grid(path, is_good ? reader->GetOutput() : nullptr);
  return reader->GetOutput();
}

/// One grid of several; nodes at the same place stay apart.
GridPointer joined(const std::string& path, const std::vector<GridPointer>& parts) {
  if (parts.empty()) check_grid(path, nullptr);
  if (parts.size() == 1) return parts.front();
  const vtkNew<vtkAppendFilter> append;
  const VtkErrorNotes notes(*append);
  for (const GridPointer& part : parts) append->AddInputData(part);
  append->Update();
  check_grid(path, notes.has_error() ? nullptr : append->GetOutput());
  return append->GetOutput();
}

/// The unstructured grids of blocks; counts others.
std::vector<GridPointer> grids_of(vtkMultiBlockDataSet& blocks, int& others) {
  std::vector<GridPointer> grids;
  const auto at = vtkSmartPointer<vtkCompositeDataIterator>::Take(blocks.NewIterator());
  for (at->InitTraversal(); at->IsDoneWithTraversal() == 0; at->GoToNextItem()) {
    vtkUnstructuredGrid* const grid = vtkUnstructuredGrid::SafeDownCast(at->GetCurrentDataObject());
    if (grid == nullptr) {
      ++others;
    } else if (grid->GetNumberOfPoints() > 0) {
      grids.emplace_back(grid);
    }
  }
  return grids;
}

void add_other_blocks(int others, ImportedMesh& into) {
  if (others > 0) {
    into.left_out.push_back(std::to_string(others) + " blocks that are no unstructured grids");
  }
}

GridPointer read_blocks(const std::string& path, int& others) {
  const vtkNew<vtkXMLMultiBlockDataReader> reader;
  const VtkErrorNotes notes(*reader);
  if (reader->CanReadFile(path.c_str()) == 0) check_grid(path, nullptr);
  reader->SetFileName(path.c_str());
  reader->Update();
  auto* const blocks = vtkMultiBlockDataSet::SafeDownCast(reader->GetOutputDataObject(0));
  const bool is_good = reader->GetErrorCode() == 0 && !notes.has_error() && blocks != nullptr;
  if (!is_good) check_grid(path, nullptr);
  return joined(path, grids_of(*blocks, others));
}

/// The grid of one file of a series.
GridPointer read_part(const std::string& path, int& others) {
  if (!std::ifstream(path)) {
    throw IoError(path, "", "cannot be opened, and a list of steps names it");
  }
  if (has_extension(path, ".vtu")) return read_xml_grid(path);
  if (has_extension(path, ".vtm")) return read_blocks(path, others);
  if (has_extension(path, ".vtk")) return read_legacy_grid(path);
  throw IoError(path, "", "is a part of a mesh, whose files must be .vtu, .vtm or .vtk");
}

void add_list(const std::vector<VtkListStep>& list, VtkSteps& into) {
  int others = 0;
  for (const VtkListStep& step : list) {
    std::vector<GridPointer> parts;
    for (const std::string& file : step.files) parts.push_back(read_part(file, others));
    into.add(step.files.front(), *joined(step.files.front(), parts), step.time);
  }
  add_other_blocks(others, into.mesh());
}

std::vector<VtkListStep> numbered_steps(const std::string& pattern) {
  std::vector<VtkListStep> steps;
  for (const std::string& file : numbered_files(pattern)) steps.push_back({std::nullopt, {file}});
  return steps;
}

/// The name of the displacement in an Exodus file: by its convention an array that begins with
/// "displ", in small or capital letters.
std::optional<std::string> exodus_displacement(vtkExodusIIReader& reader) {
  for (int a = 0; a < reader.GetNumberOfPointResultArrays(); ++a) {
    const std::string name = reader.GetPointResultArrayName(a);
    std::string small = name;
    std::ranges::transform(small, small.begin(), [](unsigned char letter) {
      return static_cast<char>(std::tolower(letter));
    });
    if (small.starts_with("displ")) return name;
  }
  return std::nullopt;
}

/// A copy of the first grid with the cells of all, whose points are the same: those of the file.
GridPointer with_shared_points(const std::string& path, const std::vector<GridPointer>& blocks) {
  const GridPointer all = joined(path, blocks);
  if (blocks.size() == 1) return all;
  const vtkIdType points = blocks.front()->GetNumberOfPoints();
  for (const GridPointer& block : blocks) {
    if (block->GetNumberOfPoints() != points) check_grid(path, nullptr);
  }
  const auto shared = vtkSmartPointer<vtkUnstructuredGrid>::New();
  shared->SetPoints(blocks.front()->GetPoints());
  shared->GetPointData()->ShallowCopy(blocks.front()->GetPointData());
  shared->GetFieldData()->ShallowCopy(blocks.front()->GetFieldData());
  const vtkNew<vtkCellArray> cells;
  vtkCellArray& joint = *all->GetCells();
  const vtkNew<vtkIdList> nodes;
  for (vtkIdType c = 0; c < all->GetNumberOfCells(); ++c) {
    joint.GetCellAtId(c, nodes);
    for (vtkIdType n = 0; n < nodes->GetNumberOfIds(); ++n) {
      nodes->SetId(n, nodes->GetId(n) % points);
    }
    cells->InsertNextCell(nodes);
  }
  shared->SetCells(all->GetCellTypesArray(), cells);
  shared->GetCellData()->ShallowCopy(all->GetCellData());
  return shared;
}

ImportedMesh read_exodus(const std::string& path, MeshImportOptions options) {
  const vtkNew<vtkExodusIIReader> reader;
  const VtkErrorNotes notes(*reader);
  if (reader->CanReadFile(path.c_str()) == 0) check_grid(path, nullptr);
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  reader->ApplyDisplacementsOff();
  reader->SetSqueezePoints(false);
  reader->GenerateObjectIdCellArrayOff();
  reader->SetAllArrayStatus(vtkExodusIIReader::NODAL, 1);
  reader->SetAllArrayStatus(vtkExodusIIReader::ELEM_BLOCK, 1);
  if (!options.displacement) options.displacement = exodus_displacement(*reader);
  vtkInformation& facts = *reader->GetOutputInformation(0);
  const int count = facts.Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
  // A copy: updates of the reader free its own list.
  std::vector<std::optional<double>> times;
  for (int step = 0; step < count; ++step) {
    times.emplace_back(facts.Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), step));
  }
  if (times.empty()) times.emplace_back();
  VtkSteps steps(options);
  int others = 0;
  for (const std::optional<double>& time : times) {
    if (time) {
      reader->UpdateTimeStep(*time);
    } else {
      reader->Update();
    }
    const bool is_good = reader->GetErrorCode() == 0 && !notes.has_error();
    if (!is_good || reader->GetOutput() == nullptr) check_grid(path, nullptr);
    others = 0;
    const GridPointer grid = with_shared_points(path, grids_of(*reader->GetOutput(), others));
    steps.add(path, *grid, time);
  }
  add_other_blocks(others, steps.mesh());
  return steps.take();
}
}  // namespace

ImportedMesh read_vtk_mesh(const std::string& path, const MeshImportOptions& options) {
  if (is_exodus_name(path)) return read_exodus(path, options);
  VtkSteps steps(options);
  if (is_pattern(path)) {
    add_list(numbered_steps(path), steps);
  } else if (has_extension(path, ".pvd")) {
    add_list(read_pvd(path), steps);
  } else if (has_extension(path, ".series")) {
    add_list(read_series(path), steps);
  } else if (has_extension(path, ".vtm")) {
    add_list({{std::nullopt, {path}}}, steps);
  } else if (has_extension(path, ".vtu")) {
    add_xml(path, steps);
  } else {
    steps.add(path, *read_legacy_grid(path), std::nullopt);
    add_tables(path, steps.mesh());
  }
  return steps.take();
}

}  // namespace tetwarp
