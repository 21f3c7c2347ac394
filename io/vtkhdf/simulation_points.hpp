/// @file simulation_points.hpp
/// Temporal points of VTKHDF, another number at every step, that can be read while a simulation
/// appends steps to them.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/io_export.hpp>
#include <tetwarp/mesh.hpp>

namespace tetwarp {

/// An array with a row per point.
struct PointArray {
  std::string name;
  int components = 1;
  bool is_integer = false;  ///< int64; false: float64
};

/// Writes a VTKHDF UnstructuredGrid, Version [2,0], of vertices (VTK type 1) step by step; a step
/// may have no point. The file has its name from the beginning and is complete after every step: a
/// program that ends early leaves a file with the steps so far. IoError where it cannot be written.
class TETWARP_IO_EXPORT StepPointsWriter {
 public:
  /// Creates the file; one of that name is replaced.
  StepPointsWriter(const std::string& path, const std::vector<PointArray>& arrays);
  /// Opens a file that has the same arrays, to append behind its first `steps` steps, and changes
  /// nothing yet: drop_later() must be called before append(). Throws IoError when it has fewer.
  StepPointsWriter(const std::string& path,
                   const std::vector<PointArray>& arrays,
                   std::int64_t steps);
  StepPointsWriter(StepPointsWriter&&) noexcept;
  ~StepPointsWriter();

  /// Removes the steps behind those that are kept.
  void drop_later();

  /// Appends a step.
  /// @param values  one span per array, [point][component], finite; whole numbers in integer arrays
  void append(double time,
              std::span<const Point3> points,
              std::span<const std::span<const double>> values);

  /// Closes the file; the destructor does so without errors.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
