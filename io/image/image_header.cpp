/// @file image_header.cpp
/// Grids and paths of headers.
#include "io/image/image_header.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <stdexcept>

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

void set_image_steps(double count, double first, double interval, ImageHeader& header) {
  if (!(count >= 1 && count <= 0x1p31)) {
    throw std::invalid_argument("has " + std::to_string(count) + " steps, expected 1 to 2^31");
  }
  header.steps = static_cast<std::int64_t>(count);
  header.is_series = true;
  header.first_time = std::isfinite(first) ? first : 0;
  header.time_step = std::isfinite(interval) && interval > 0 ? interval : 1;
}

std::string shortest_text(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

std::string beside(const std::string& file, const std::string& name) {
  return (std::filesystem::path(file).parent_path() / name).string();
}

}  // namespace tetwarp
