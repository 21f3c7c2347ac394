/// @file overlap.hpp
/// Conservative intensity in the reference: overlaps of tetrahedra and boxes of voxels, by
/// clipping.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <type_traits>
#include <vector>

#include <tetwarp/warp.hpp>

#include "host/base/counter_hash.hpp"
#include "host/reference/warp/exact_geometry.hpp"
#include "host/reference/warp/sample.hpp"

namespace tetwarp::reference {

/// Voxels of a grid along each axis.
using Dims = std::array<std::int64_t, 3>;

/// Callback: output voxel, source voxel, and the volume of the part of the source voxel's box that
/// the deformation moves into the output voxel's box [source voxel].
using Visit = std::function<void(std::int64_t, std::int64_t, double)>;

/// Calls `visit` for all overlaps of one tetrahedron that is not flat.
void for_overlaps(const Corners& rest,
                  const Corners& now,
                  const Dims& source,
                  const Dims& output,
                  const Visit& visit);

/// Callback: source voxel, and the volume of its box within a tetrahedron [source voxel].
using VisitHeld = std::function<void(std::int64_t, double)>;

/// Calls `visit` for all source voxels whose boxes overlap a tetrahedron at rest.
void for_held(const Corners& rest, const Dims& source, const VisitHeld& visit);

/// A tetrahedron at rest in the source's and deformed in the output's index space.
struct MovedTet {
  Corners rest, now;
};

/// What storing the values of one component as integers adds to their sum.
struct StoringChange {
  double rounding = 0, clipping = 0;
  std::int64_t clipped = 0;  ///< values beyond the limits of the type
};

/// Rounds up with the probability of the fraction: if this is above entry `index` of the numbers in
/// [0, 1) that SplitMix64 with seed 0 generates.
template <class T>
T stored_by_chance(double value, std::int64_t index, StoringChange& change) {
  constexpr std::uint64_t increment = 0x9e3779b97f4a7c15;
  const double chance = unit_of(static_cast<std::uint64_t>(index) * increment);
  const double whole = std::floor(value) + (value - std::floor(value) > chance ? 1 : 0);
  const T result = stored<T>(whole);
  change.rounding += whole - value;
  change.clipping += static_cast<double>(result) - whole;
  change.clipped += static_cast<double>(result) != whole;
  return result;
}

/// Writes to every voxel of a region the amount that tetrahedra carry into its box, over its
/// volume.
/// @param region  of an output grid with `grid_dims` voxels
/// @param ratio   volume of a source voxel over that of an output voxel
/// @param out     [voxel of the region][component]
/// @returns what storing has changed, per component
template <class T>
std::vector<StoringChange> carry(const VolumeView& source,
                                 const std::vector<MovedTet>& tets,
                                 const Region& region,
                                 const Dims& grid_dims,
                                 double ratio,
                                 T* out) {
  const T* samples = static_cast<const T*>(source.data);
  const std::int64_t components = source.components;
  Dims dims;
  for (std::size_t axis = 0; axis < 3; ++axis) dims[axis] = region.end[axis] - region.begin[axis];
  std::vector<double> sums(static_cast<std::size_t>(dims[0] * dims[1] * dims[2] * components), 0.0);
  for (auto [rest, now] : tets) {
    if (signed_volume(now) == 0) continue;
    for (Quanta& node : now) {
      for (std::size_t axis = 0; axis < 3; ++axis) node[axis] -= region.begin[axis] * one_voxel_int;
    }
    for_overlaps(rest, now, source.grid.dims, dims,
                 [&](std::int64_t voxel, std::int64_t from, double volume) {
                   for (std::int64_t c = 0; c < components; ++c) {
                     sums[static_cast<std::size_t>(voxel * components + c)] +=
                         volume * ratio * static_cast<double>(samples[from * components + c]);
                   }
                 });
  }
  std::vector<StoringChange> changes(static_cast<std::size_t>(components));
  for (std::int64_t n = 0; n < std::ssize(sums); ++n) {
    const double sum = sums[static_cast<std::size_t>(n)];
    if constexpr (std::is_floating_point_v<T>) {
      out[n] = stored<T>(sum);
    } else {
      const std::int64_t v = n / components, c = n % components;
      const std::int64_t i = region.begin[0] + v % dims[0];
      const std::int64_t j = region.begin[1] + v / dims[0] % dims[1];
      const std::int64_t k = region.begin[2] + v / (dims[0] * dims[1]);
      const std::int64_t index = ((k * grid_dims[1] + j) * grid_dims[0] + i) * components + c;
      out[n] = stored_by_chance<T>(sum, index, changes[static_cast<std::size_t>(c)]);
    }
  }
  return changes;
}

/// The label with the largest volume in the box of every voxel of a region: of those whose shares
/// of the box exceed no lower one by more than 2^-16 the lowest. What no label fills is background.
/// @param label_of  label of a source voxel
std::vector<double> elected(const std::function<double(std::int64_t)>& label_of,
                            const Dims& source,
                            const std::vector<MovedTet>& tets,
                            const Region& region,
                            double background);

/// Integral of a source over the tetrahedra at rest, component by component [source voxel].
template <class T>
std::vector<double> total_held(const VolumeView& source, const std::vector<MovedTet>& tets) {
  std::vector<double> totals(static_cast<std::size_t>(source.components), 0.0);
  for (const MovedTet& tet : tets) {
    for_held(tet.rest, source.grid.dims, [&](std::int64_t from, double volume) {
      const T* sample = static_cast<const T*>(source.data) + from * source.components;
      for (double& sum : totals) sum += volume * static_cast<double>(*sample++);
    });
  }
  return totals;
}

}  // namespace tetwarp::reference
