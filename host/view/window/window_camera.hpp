/// @file window_camera.hpp
/// Cameras of VTK as those of scenes.
#pragma once
#include <vtkCamera.h>
#include <tetwarp/make.hpp>

namespace tetwarp::view {

Camera camera_of(vtkCamera* camera);

void set_camera(const Camera& from, vtkCamera* camera);

}  // namespace tetwarp::view
