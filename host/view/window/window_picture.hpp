/// @file window_picture.hpp
/// What a window shows.
#pragma once
#include <string>

#include <vtkRenderWindow.h>
#include <tetwarp/make.hpp>

namespace tetwarp::view {

/// Draws the window again and reads it.
Image picture_of(vtkRenderWindow* window);

}  // namespace tetwarp::view
