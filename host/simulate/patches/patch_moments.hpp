/// @file patch_moments.hpp
/// Area, centroid and second moments of a patch, and four points with the same ones.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/collide/touch_areas.hpp"
#include "host/simulate/patches/patch_frame.hpp"

namespace tetwarp {

/// One of the four points; it has a quarter of the patch's area.
struct PatchPoint {
  Point3 middle{0, 0, 0};  ///< halfway between the surfaces [world]
  double gap = 0;          ///< on the plane fitted to the gaps of the patch [m]
};

struct PatchPoints {
  double area = 0;         ///< [m^2]; 0: there are no points
  Point3 normal{0, 0, 1};  ///< mean over the area
  std::array<PatchPoint, 4> point;
};

/// Computes the points of patches; keeps its memory.
class PatchMoments {
 public:
  /// @param areas  kept by the caller
  PatchMoments(const TouchAreas& areas, const CollisionSurfaces& surfaces)
      : areas_(areas), surfaces_(surfaces) {}

  /// @param patch     indices of `contacts`
  /// @param vertices  at the start of the step
  PatchPoints points_of(const std::vector<ReportedContact>& contacts,
                        const std::vector<std::size_t>& patch,
                        const std::vector<Point3>& vertices);

 private:
  /// Second moments along the axes of a frame [m^4].
  struct Moments {
    double xx = 0, xy = 0, yy = 0;
    void add(double weight, const std::array<double, 2>& x) {
      xx += weight * x[0] * x[0];
      xy += weight * x[0] * x[1];
      yy += weight * x[1] * x[1];
    }
  };
  void spread_triangles(const std::vector<ReportedContact>& contacts,
                        const PatchFrame& frame,
                        const std::vector<Point3>& vertices,
                        Moments& moments);

  const TouchAreas& areas_;
  const CollisionSurfaces& surfaces_;
  std::vector<std::pair<std::int32_t, std::size_t>> corners_;  ///< vertex and contact, sorted
};

}  // namespace tetwarp
