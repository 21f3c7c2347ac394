/// @file window_camera.cpp
/// Angles in degrees and radians.
#include "host/view/window/window_camera.hpp"

#include <numbers>

namespace tetwarp::view {
namespace {
constexpr double degree = std::numbers::pi / 180;
}

Camera camera_of(vtkCamera* camera) {
  Camera of;
  camera->GetPosition(of.eye.data());
  camera->GetFocalPoint(of.target.data());
  camera->GetViewUp(of.up.data());
  of.angle = camera->GetViewAngle() * degree;
  return of;
}

void set_camera(const Camera& from, vtkCamera* camera) {
  camera->SetPosition(from.eye.data());
  camera->SetFocalPoint(from.target.data());
  camera->SetViewUp(from.up.data());
  camera->SetViewAngle(from.angle / degree);
}

}  // namespace tetwarp::view
