/// @file mouse_style.cpp
/// Events of mouse and keys.
#include "host/view/window/mouse_style.hpp"

#include <vtkObjectFactory.h>
#include <vtkRenderWindowInteractor.h>

namespace tetwarp::view {

vtkStandardNewMacro(MouseStyle);

void MouseStyle::OnLeftButtonDown() {
  vtkRenderWindowInteractor* const events = GetInteractor();
  const int* const place = events->GetEventPosition();
  const bool may_grab = events->GetShiftKey() == 0 && events->GetControlKey() == 0;
  edits_ = actions_.take_point(place[0], place[1], false);
  grabs_ = !edits_ && may_grab && actions_.grab(place[0], place[1]);
  if (!edits_ && !grabs_) Superclass::OnLeftButtonDown();
}

void MouseStyle::OnLeftButtonUp() {
  if (grabs_) {
    grabs_ = false;
    actions_.release();
  } else if (edits_) {
    edits_ = false;
  } else {
    Superclass::OnLeftButtonUp();
  }
}

void MouseStyle::OnRightButtonDown() {
  if (grabs_) return;
  const int* const place = GetInteractor()->GetEventPosition();
  edits_ = actions_.take_point(place[0], place[1], true);
  turns_ = !edits_ && actions_.turn_window(0, 0);
  if (!edits_ && !turns_) Superclass::OnRightButtonDown();
}

void MouseStyle::OnRightButtonUp() {
  if (!edits_ && !turns_) return Superclass::OnRightButtonUp();
  edits_ = turns_ = false;
}

void MouseStyle::OnMouseMove() {
  const int* const place = GetInteractor()->GetEventPosition();
  const int* const before = GetInteractor()->GetLastEventPosition();
  if (edits_) return actions_.move_point(place[0], place[1]);
  if (grabs_) return actions_.pull(place[0], place[1]);
  if (turns_) {
    actions_.turn_window(place[0] - before[0], place[1] - before[1]);
    return;
  }
  Superclass::OnMouseMove();
}

void MouseStyle::OnKeyPress() {
  const char* const key = GetInteractor()->GetKeySym();
  if (key != nullptr) actions_.press(key);
}

}  // namespace tetwarp::view
