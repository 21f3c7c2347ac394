/// @file pointer.hpp
/// Pointer: from pixels to the scene and back.
#pragma once
#include <vtkRenderer.h>

#include "host/view/pick.hpp"

namespace tetwarp::view {

/// Pixels count from the lower left; the place of one is its middle.
class Pointer {
 public:
  /// @param renderer  kept by the caller
  explicit Pointer(vtkRenderer* renderer) : renderer_(renderer) {}

  /// @param depth  of the display, 0 to 1
  Point3 world_of(int x, int y, double depth) const;
  double depth_of(const Point3& point) const;
  EyeRay ray_at(int x, int y) const;
  EyeRay ray_at(const int* place) const { return ray_at(place[0], place[1]); }

 private:
  vtkRenderer* renderer_;
};

}  // namespace tetwarp::view
