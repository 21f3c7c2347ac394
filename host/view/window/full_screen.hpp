/// @file full_screen.hpp
/// FullScreen: a window of VTK as large as its display, and back.
#pragma once
#include <array>

#include <vtkRenderWindow.h>

namespace tetwarp::view {

class FullScreen {
 public:
  /// @param window  of X11; kept by the caller
  explicit FullScreen(vtkRenderWindow* window) : window_(window) {}

  /// Fills the display, or goes back to size and place before. The window manager does it, or where
  /// there is none the window itself.
  void turn();

 private:
  bool ask_manager() const;

  vtkRenderWindow* window_;
  bool is_full_ = false;         ///< where there is no window manager
  std::array<int, 4> before_{};  ///< left, top, width, height
};

}  // namespace tetwarp::view
