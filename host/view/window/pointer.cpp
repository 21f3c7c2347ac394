/// @file pointer.cpp
/// By the matrices of VTK's camera.
#include "host/view/window/pointer.hpp"

#include "host/base/point3.hpp"

namespace tetwarp::view {

Point3 Pointer::world_of(int x, int y, double depth) const {
  renderer_->SetDisplayPoint(x + 0.5, y + 0.5, depth);
  renderer_->DisplayToWorld();
  const double* const world = renderer_->GetWorldPoint();
  return {world[0] / world[3], world[1] / world[3], world[2] / world[3]};
}

double Pointer::depth_of(const Point3& point) const {
  renderer_->SetWorldPoint(point[0], point[1], point[2], 1);
  renderer_->WorldToDisplay();
  return renderer_->GetDisplayPoint()[2];
}

EyeRay Pointer::ray_at(int x, int y) const {
  const Point3 near = world_of(x, y, 0);
  return {near, minus(world_of(x, y, 1), near)};
}

}  // namespace tetwarp::view
