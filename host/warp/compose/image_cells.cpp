/// @file image_cells.cpp
/// Boxes around the images of cells: corners of a linear cell, coefficients around one of a spline.
#include "host/warp/compose/image_cells.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <variant>

#include "host/base/parallel.hpp"

namespace tetwarp {
namespace {
/// The displacement of a node, or of the nearest one.
template <class Number>
Point3 displacement(const Grid& grid, const Number* numbers, std::array<std::int64_t, 3> node) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    node[axis] = std::clamp<std::int64_t>(node[axis], 0, grid.dims[axis] - 1);
  }
  const Number* const at =
      numbers + 3 * (node[0] + grid.dims[0] * (node[1] + grid.dims[1] * node[2]));
  return {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
}
}  // namespace

ImageCells::ImageCells(const Transform& field, int threads) {
  if (const auto* const spline = std::get_if<BSplineTransform>(&field)) {
    grid_ = &spline->grid;
    spline_ = spline->coefficients.data();
    first_ = 1;
    end_ = -2;
  } else {
    const auto& linear = std::get<DisplacementField>(field);
    grid_ = &linear.grid;
    linear_ = linear.displacement.data();
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    brick_count_[axis] = (grid_->dims[axis] + end_ - first_ + side - 1) / side;
  }
  bricks_.resize(static_cast<std::size_t>(brick_count_[0] * brick_count_[1] * brick_count_[2]));
  parallel_for(threads, std::ssize(bricks_), [&](std::int64_t brick) {
    Bounds& box = bricks_[static_cast<std::size_t>(brick)];
    for_each_cell(brick, [&](const Point3&, const Point3&, const Bounds& image) {
      box.include(image.low);
      box.include(image.high);
    });
  });
}

bool ImageCells::meet(const Bounds& a, const Bounds& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(a.high[axis] >= b.low[axis] && a.low[axis] <= b.high[axis])) return false;
  }
  return true;
}

/// The index of a node of the cells: half a voxel before the first center along an axis, the
/// centers, half a voxel behind the last one [voxel].
Point3 ImageCells::index_of(const Cell& node) const {
  Point3 index{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    index[axis] = std::clamp(static_cast<double>(node[axis]), -0.5,
                             static_cast<double>(grid_->dims[axis]) - 0.5);
  }
  return index;
}

Bounds ImageCells::image_of(const Cell& cell) const {
  Bounds image;
  for (int corner = 0; corner < 8; ++corner) {
    Cell node = cell;
    for (std::size_t axis = 0; axis < 3; ++axis) node[axis] += corner >> axis & 1;
    const Point3 x = grid_->world_of(index_of(node));
    image.include(linear_ != nullptr ? plus(x, displacement(*grid_, linear_, node)) : x);
  }
  if (spline_ != nullptr) widen(cell, image);
  return image;
}

/// By the largest and smallest coefficients around a cell: a spline is a mean of them.
void ImageCells::widen(const Cell& cell, Bounds& image) const {
  Bounds range;
  for (int n = 0; n < 64; ++n) {
    range.include(displacement(
        *grid_, spline_, {cell[0] - 1 + n % 4, cell[1] - 1 + n / 4 % 4, cell[2] - 1 + n / 16}));
  }
  image.low = plus(image.low, range.low);
  image.high = plus(image.high, range.high);
}

}  // namespace tetwarp
