/// @file mouse_style.hpp
/// MouseStyle: what mouse and keys do in the window.
#pragma once
#include <functional>
#include <string>

#include <vtkInteractorStyleTrackballCamera.h>

#include "host/view/camera_keys.hpp"

namespace tetwarp::view {

/// What the window does for the mouse; places are pixels from the lower left.
struct MouseActions {
  std::function<bool(int x, int y)> grab;  ///< false: nothing is there
  std::function<void(int x, int y)> pull;
  std::function<void()> release;
  /// Moves the window of volumes by pixels; false: there are none to see.
  std::function<bool(int x, int y)> turn_window;
  /// Takes a point of the curve of volumes; `tints`: to change its color. False: no curve is there.
  std::function<bool(int x, int y, bool tints)> take_point;
  std::function<void(int x, int y)> move_point;
  /// Moves the slice under the pointer; false: slices are not shown.
  std::function<bool(int x, int y, int steps)> move_slice;
  std::function<void(const PressedKey& key)> press;
};

/// Left drags what is under the pointer, a point of a curve too, or turns the camera; right drags
/// the window of volumes, or zooms; neither does anything while the other one holds something.
/// Everything else is that of VTK's trackball: Shift and left or
/// middle pan, Ctrl and left spins, the wheel zooms, with Shift it moves slices. Keys of VTK do
/// nothing.
class MouseStyle : public vtkInteractorStyleTrackballCamera {
 public:
  static MouseStyle* New();
  vtkTypeMacro(MouseStyle, vtkInteractorStyleTrackballCamera);

  void set_actions(MouseActions actions) { actions_ = std::move(actions); }
  /// What the mouse holds is let go, though its button is held. @returns whether there was anything
  bool let_go();

  void OnLeftButtonDown() override;
  void OnLeftButtonUp() override;
  void OnRightButtonDown() override;
  void OnRightButtonUp() override;
  void OnMouseMove() override;
  void OnMouseWheelForward() override;
  void OnMouseWheelBackward() override;
  void OnKeyPress() override;
  void OnChar() override {}

 private:
  bool follow();
  bool turn_wheel(int steps);

  MouseActions actions_;
  bool grabs_ = false, edits_ = false;  ///< by the left button
  bool turns_ = false, tints_ = false;  ///< by the right one
};

}  // namespace tetwarp::view
