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
  grabs_ = may_grab && actions_.grab(place[0], place[1]);
  if (!grabs_) Superclass::OnLeftButtonDown();
}

void MouseStyle::OnLeftButtonUp() {
  if (!grabs_) return Superclass::OnLeftButtonUp();
  grabs_ = false;
  actions_.release();
}

void MouseStyle::OnRightButtonDown() {
  turns_ = actions_.turn_window(0, 0);
  if (!turns_) Superclass::OnRightButtonDown();
}

void MouseStyle::OnRightButtonUp() {
  if (!turns_) return Superclass::OnRightButtonUp();
  turns_ = false;
}

void MouseStyle::OnMouseMove() {
  const int* const place = GetInteractor()->GetEventPosition();
  const int* const before = GetInteractor()->GetLastEventPosition();
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
