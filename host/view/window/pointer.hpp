/// @file pointer.hpp
/// Pointer: from pixels to the scene and back.
#pragma once
#include <vtkRenderer.h>
#include <tetwarp/volume.hpp>

namespace tetwarp::view {

/// A half-line from the eye.
struct EyeRay {
  Point3 origin{}, direction{};
};

/// Pixels count from the lower left; the place of one is its middle.
class Pointer {
 public:
  /// @param renderer  kept by the caller
  explicit Pointer(vtkRenderer* renderer) : renderer_(renderer) {}

  /// @param depth  of the display, 0 to 1
  Point3 world_of(int x, int y, double depth) const;
  double depth_of(const Point3& point) const;
  EyeRay ray_at(int x, int y) const;

 private:
  vtkRenderer* renderer_;
};

}  // namespace tetwarp::view
