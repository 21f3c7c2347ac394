/// @file window_picture.hpp
/// What a window shows.
#pragma once
#include <string>

#include <vtkRenderWindow.h>
#include <tetwarp/make.hpp>

namespace tetwarp::view {

/// Whether a window that has drawn something is drawn without a graphics processor.
bool is_software(vtkRenderWindow* window);

/// What a window has drawn last.
Image drawn_picture_of(vtkRenderWindow* window);

/// view_0000 or the next number that no file in the working folder has, with this ending.
std::string free_name(const std::string& ending);

/// Draws the window again and reads it.
Image picture_of(vtkRenderWindow* window);

}  // namespace tetwarp::view
