/// @file displacement.cpp
/// Writes the steps of a procedural displacement.
#include "host/cli/tools/displacement.hpp"

#include <cstddef>
#include <tetwarp/io.hpp>
#include <vector>

namespace tetwarp::cli {

void write_deformed_mesh(const std::string& path,
                         const Mesh& mesh,
                         const DeformOptions& options,
                         int step_count) {
  std::vector<double> times;
  std::vector<std::vector<Point3>> displacements;
  for (int step = 0; step < step_count; ++step) {
    times.push_back(step_count == 1 ? 1.0 : static_cast<double>(step) / (step_count - 1));
    std::vector<Point3> positions = deform_positions(mesh, options, times.back());
    for (std::size_t n = 0; n < positions.size(); ++n) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        positions[n][axis] -= mesh.rest_positions[n][axis];
      }
    }
    displacements.push_back(std::move(positions));
  }
  write_mesh(path, mesh, displacements, times);
}

}  // namespace tetwarp::cli
