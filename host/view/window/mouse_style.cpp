/// @file mouse_style.cpp
/// Events of mouse and keys.
#include "host/view/window/mouse_style.hpp"

#include <vtkObjectFactory.h>
#include <vtkRenderWindowInteractor.h>

namespace tetwarp::view {

vtkStandardNewMacro(MouseStyle);

void MouseStyle::OnLeftButtonDown() {
  if (tints_ || turns_ || GetState() != VTKIS_NONE) return;
  vtkRenderWindowInteractor* const events = GetInteractor();
  const int* const place = events->GetEventPosition();
  const bool may_grab = events->GetShiftKey() == 0 && events->GetControlKey() == 0;
  edits_ = actions_.take_point(place[0], place[1], false);
  grabs_ = !edits_ && may_grab && actions_.grab(place[0], place[1]);
  if (!edits_ && !grabs_) Superclass::OnLeftButtonDown();
}

void MouseStyle::OnLeftButtonUp() {
  if (tints_ || turns_) return;
  follow();
  if (!edits_ && !grabs_) return Superclass::OnLeftButtonUp();
  if (grabs_) actions_.release();
  grabs_ = edits_ = false;
}

void MouseStyle::OnRightButtonDown() {
  if (grabs_ || edits_ || GetState() != VTKIS_NONE) return;
  const int* const place = GetInteractor()->GetEventPosition();
  tints_ = actions_.take_point(place[0], place[1], true);
  turns_ = !tints_ && actions_.turn_window(0, 0);
  if (!tints_ && !turns_) Superclass::OnRightButtonDown();
}

void MouseStyle::OnRightButtonUp() {
  if (grabs_ || edits_) return;
  follow();
  if (!tints_ && !turns_) return Superclass::OnRightButtonUp();
  tints_ = turns_ = false;
}

void MouseStyle::OnMouseMove() {
  if (!follow()) Superclass::OnMouseMove();
}

/// Takes what the mouse holds to where the event was; also where a button was released, since X11
/// may have left out the motion before. @returns whether it holds anything
bool MouseStyle::follow() {
  const int* const place = GetInteractor()->GetEventPosition();
  const int* const before = GetInteractor()->GetLastEventPosition();
  if (edits_ || tints_) {
    actions_.move_point(place[0], place[1]);
  } else if (grabs_) {
    actions_.pull(place[0], place[1]);
  } else if (turns_) {
    actions_.turn_window(place[0] - before[0], place[1] - before[1]);
  }
  return edits_ || grabs_ || tints_ || turns_;
}

bool MouseStyle::let_go() {
  const bool has_held = edits_ || grabs_ || tints_ || turns_;
  if (grabs_) actions_.release();
  edits_ = grabs_ = tints_ = turns_ = false;
  return has_held;
}

bool MouseStyle::turn_wheel(int steps) {
  const int* const place = GetInteractor()->GetEventPosition();
  return GetInteractor()->GetShiftKey() != 0 && actions_.move_slice(place[0], place[1], steps);
}

void MouseStyle::OnMouseWheelForward() {
  if (!turn_wheel(1)) Superclass::OnMouseWheelForward();
}

void MouseStyle::OnMouseWheelBackward() {
  if (!turn_wheel(-1)) Superclass::OnMouseWheelBackward();
}

void MouseStyle::OnKeyPress() {
  vtkRenderWindowInteractor* const events = GetInteractor();
  const char* const key = events->GetKeySym();
  if (key == nullptr) return;
  actions_.press({key, events->GetShiftKey() != 0, events->GetControlKey() != 0});
}

}  // namespace tetwarp::view
