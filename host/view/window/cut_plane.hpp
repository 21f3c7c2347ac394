/// @file cut_plane.hpp
/// CutPlane: hides what is before a plane.
#pragma once
#include <optional>

#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkRenderer.h>

#include "host/view/pick.hpp"

namespace tetwarp::view {

class CutPlane {
 public:
  /// Cuts everything that a renderer has now; nothing: no longer.
  void set(const std::optional<Cut>& cut, vtkRenderer* renderer);
  /// Cuts at a point as the camera looks, or no longer.
  void turn(const Point3& point, vtkRenderer* renderer);
  /// Moves the cut against its normal. @param way  [m]
  void move(double way, vtkRenderer* renderer);
  const std::optional<Cut>& cut() const { return cut_; }

 private:
  std::optional<Cut> cut_;
  vtkNew<vtkPlane> plane_;
};

}  // namespace tetwarp::view
