/// @file slice_look.cpp
/// Slices through the centers of voxels.
#include "host/view/look/slice_look.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
constexpr double slice_step = 0.02;  // of the volume
}

std::int64_t slice_number(const Grid& grid, std::size_t axis, double place) {
  return std::llround(place * static_cast<double>(grid.dims[axis] - 1));
}

void choose_next(SliceLook& slices) {
  if (!slices.alone) {
    slices.alone = 0;
  } else if (++*slices.alone == 3) {
    slices.alone.reset();
  }
}

std::optional<MetSlice> slice_at(const Grid& grid,
                                 const SliceLook& slices,
                                 const Point3& origin,
                                 const Point3& direction) {
  std::optional<MetSlice> first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!slices.shows(axis) || direction[axis] == 0) continue;
    const auto number = static_cast<double>(slice_number(grid, axis, slices.places[axis]));
    const double at = grid.origin[axis] + number * grid.spacing[axis];
    const double distance = (at - origin[axis]) / direction[axis];
    if (!(distance > 0) || (first && distance >= first->distance)) continue;
    const Point3 x = plus(origin, times(distance, direction));
    const bool is_within = std::ranges::all_of(std::array{0, 1, 2}, [&](int d) {
      const auto n = static_cast<std::size_t>(d);
      const double voxel = (x[n] - grid.origin[n]) / grid.spacing[n];
      return n == axis || (voxel >= 0 && voxel <= static_cast<double>(grid.dims[n] - 1));
    });
    if (is_within) first = MetSlice{axis, distance};
  }
  return first;
}

void move_slice(SliceLook& slices, std::size_t axis, int steps) {
  double& place = slices.places[axis];
  place = std::clamp(place + slice_step * steps, 0.0, 1.0);
}

}  // namespace tetwarp::view
