/// @file slice_look.hpp
/// Which slices of volumes are shown, and where.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tetwarp/volume.hpp>

namespace tetwarp::view {

/// Of all volumes: shares of each volume's grid, so that slices go along when a grid follows its
/// body.
struct SliceLook {
  std::array<double, 3> places{0.5, 0.5, 0.5};  ///< across x, y and z, 0 to 1
  std::optional<std::size_t> alone = {};        ///< the only one that is shown

  bool shows(std::size_t axis) const { return !alone || *alone == axis; }
  bool operator==(const SliceLook&) const = default;
};

/// @param place  0 to 1, across the axis
/// @returns the number of the slice in a grid, from 0
std::int64_t slice_number(const Grid& grid, std::size_t axis, double place);

/// All, then each alone, then all again.
void choose_next(SliceLook& slices);

/// Where a ray meets a slice.
struct MetSlice {
  std::size_t axis = 0;  ///< that the slice is across
  double distance = 0;   ///< from the ray's origin, in lengths of its direction
};

/// @pre the axes of the grid are those of the world
/// @returns the shown slice that a ray meets first; none: it meets none
std::optional<MetSlice> slice_at(const Grid& grid,
                                 const SliceLook& slices,
                                 const Point3& origin,
                                 const Point3& direction);

/// Moves a slice by steps of a fiftieth of its volume.
void move_slice(SliceLook& slices, std::size_t axis, int steps);

}  // namespace tetwarp::view
