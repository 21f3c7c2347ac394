/// @file image_header.cpp
/// Grids and paths of headers.
#include "io/image/image_header.hpp"

#include <cmath>
#include <filesystem>

namespace tetwarp {

void set_image_axes(const std::array<Point3, 3>& steps,
                    const Point3& origin,
                    const std::array<bool, 3>& is_negated,
                    Grid& grid) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Point3& step = steps[axis];
    grid.spacing[axis] = std::hypot(step[0], step[1], step[2]);
    for (std::size_t row = 0; row < 3; ++row) {
      const double along = step[row] / grid.spacing[axis];
      grid.direction[3 * row + axis] = is_negated[row] ? 0 - along : along;
    }
  }
  for (std::size_t row = 0; row < 3; ++row) {
    grid.origin[row] = is_negated[row] ? 0 - origin[row] : origin[row];
  }
  check_grid(grid, "grid");
}

std::string beside(const std::string& file, const std::string& name) {
  return (std::filesystem::path(file).parent_path() / name).string();
}

}  // namespace tetwarp
