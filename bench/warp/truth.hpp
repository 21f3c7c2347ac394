/// @file truth.hpp
/// Exact owners and positions of some voxels of a warp, and the errors of a result.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/warp.hpp>

#include "tests/support/scenes.hpp"

namespace tetwarp::bench {

/// Owners and source positions of some output voxels: owners from signs of determinants in exact
/// integers, positions in float64, both with the geometry of the reference back end.
struct Truth {
  std::vector<std::int64_t> voxels;  ///< indices into the output volume
  std::vector<std::int32_t> owners;  ///< -1: no tetrahedron covers the voxel
  std::vector<Point3> positions;     ///< in the source [voxel], where there is an owner

  /// All voxels of the output are in `voxels`.
  bool is_complete = false;
};

/// The index of a voxel as a position [voxel].
inline Point3 position_of(std::int64_t voxel, const Grid& grid) {
  const std::int64_t row = voxel / grid.dims[0], slice = row / grid.dims[1];
  return {static_cast<double>(voxel % grid.dims[0]), static_cast<double>(row % grid.dims[1]),
          static_cast<double>(slice)};
}

/// All voxels for sources of up to 128^3, else 100,000 seeded ones.
Truth make_truth(const scenes::Scene& scene);

/// The float64 value of a component at a source position.
/// @returns the value, or nothing outside of the source, and for the nearest filter within 1e-4
///          voxel of a place where the nearest sample changes
std::optional<double> sample_truth(const VolumeView& source,
                                   Filter filter,
                                   const Point3& position,
                                   int component = 0);

/// The absolute difference; infinite for a NaN, so that no comparison accepts it.
double error_between(double value, double expected);

/// Errors of a result.
struct Accuracy {
  std::int64_t compared = 0;  ///< voxels
  std::int64_t holes = 0;     ///< covered, but without an owner
  std::int64_t painted = 0;   ///< not covered, but with an owner or a value other than zero
  std::int64_t doubles = 0;   ///< owned by another tetrahedron than the lowest that covers it
  double max_error = 0;       ///< of the values of covered voxels, as a share of the image's range
  double rms_error = 0;
};

/// @param source  what was warped
/// @param output  samples of the source's type and components, background zero
/// @param owner   as WarpTarget::owner
Accuracy compare(const Truth& truth,
                 const VolumeView& source,
                 Filter filter,
                 const void* output,
                 const std::int32_t* owner);

/// The largest error a correct result can have: rounding of the arithmetic, and for integers of the
/// result, as a share of the image's range.
double error_bound(PixelType type, Filter filter);

/// @returns why a result is wrong, or nothing: wrong owners, too large errors, or counters that
///          contradict each other or `owner`
std::optional<std::string> fault_of(const Accuracy& accuracy,
                                    double bound,
                                    const Counts& counts,
                                    const scenes::Scene& scene,
                                    const std::int32_t* owner);

}  // namespace tetwarp::bench
