/// @file simulation_mesh.hpp
/// Temporal meshes of VTKHDF that can be read while a simulation appends steps to them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/io_export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/scene.hpp>

namespace tetwarp {

/// An array of float64 with values of its own at every step.
struct StepArray {
  std::string name;
  bool is_of_cells = false;  ///< a row per cell; false: a row per point
  int components = 1;
};

/// Writes a VTKHDF UnstructuredGrid, Version [2,0], of fixed points and cells step by step. The
/// file has its name from the beginning, and is complete and closed between calls: a program that
/// ends early leaves a file with the steps up to the last flush(). IoError where it cannot be
/// written.
class TETWARP_IO_EXPORT StepMeshWriter {
 public:
  /// Creates the file; one of that name is replaced.
  StepMeshWriter(const std::string& path, const Mesh& mesh, const std::vector<StepArray>& arrays);
  /// Of triangles.
  StepMeshWriter(const std::string& path,
                 const Surface& surface,
                 const std::vector<StepArray>& arrays);
  /// Opens a file that has the same arrays, to append behind its first `steps` steps, and changes
  /// nothing yet: drop_later() must be called before append(). Throws IoError when it has fewer
  /// steps, or another number of points.
  StepMeshWriter(const std::string& path,
                 std::size_t point_count,
                 const std::vector<StepArray>& arrays,
                 std::int64_t steps);
  StepMeshWriter(StepMeshWriter&&) noexcept;
  ~StepMeshWriter();  ///< flushes without errors

  /// Removes the steps behind those that are kept.
  void drop_later();

  /// Appends a step, which flush() writes: several steps at once take little longer than one.
  /// @param values  one span per array, [row][component], finite
  void append(double time, std::span<const std::span<const double>> values);
  /// After an error the steps that it was to write are lost.
  void flush();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
