/// @file vtk_steps.hpp
/// A mesh of several steps from VTK's unstructured grids.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <tetwarp/mesh_import.hpp>
#include <vector>

class vtkUnstructuredGrid;

namespace tetwarp {

/// Takes a mesh step by step: cells, rest positions and other arrays from the first one, from every
/// step the displacement or, where no array holds it, the points, if they move.
class VtkSteps {
 public:
  explicit VtkSteps(const MeshImportOptions& options) : options_(options) {}

  /// Adds a step. Its time is the field array TimeValue, else `time`, else its number.
  /// @param file  of the grid, for messages
  /// @throws IoError when it has other points or cells than the first step, or lacks the
  ///         displacement
  void add(const std::string& file, vtkUnstructuredGrid& grid, std::optional<double> time);

  /// The mesh, once. @pre a step was added
  ImportedMesh take();

  ImportedMesh& mesh() { return mesh_; }

 private:
  void start(const std::string& file, vtkUnstructuredGrid& grid);
  void check_same_mesh(const std::string& file, vtkUnstructuredGrid& grid, bool has_cells) const;

  MeshImportOptions options_;
  ImportedMesh mesh_;
  std::optional<std::string> displacement_;   ///< name of the array
  std::string file_;                          ///< of the first step
  std::vector<std::int64_t> nodes_of_cells_;  ///< of the first step, with their types
  int count_ = 0;
  bool is_timed_ = true;
  bool moves_ = false;  ///< points of some step differ from those of the first
};

/// Throws IoError unless the grid has points.
void check_grid(const std::string& path, vtkUnstructuredGrid* grid);

}  // namespace tetwarp
