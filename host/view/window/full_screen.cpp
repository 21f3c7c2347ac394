/// @file full_screen.cpp
/// The request _NET_WM_STATE of the Extended Window Manager Hints.
#include "host/view/window/full_screen.hpp"

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <cstdint>

namespace tetwarp::view {
namespace {
/// Whether a window manager says that it is there.
bool has_manager(Display* display) {
  Atom type = None;
  int format = 0;
  unsigned long count = 0, rest = 0;
  unsigned char* value = nullptr;
  XGetWindowProperty(display, DefaultRootWindow(display),
                     XInternAtom(display, "_NET_SUPPORTING_WM_CHECK", False), 0, 1, False,
                     XA_WINDOW, &type, &format, &count, &rest, &value);
  if (value != nullptr) XFree(value);
  return count > 0;
}
}  // namespace

/// @returns whether there is a window manager
bool FullScreen::ask_manager() const {
  auto* const display = static_cast<Display*>(window_->GetGenericDisplayId());
  if (!has_manager(display)) return false;
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = reinterpret_cast<std::uintptr_t>(window_->GetGenericWindowId());
  event.xclient.message_type = XInternAtom(display, "_NET_WM_STATE", False);
  event.xclient.format = 32;
  event.xclient.data.l[0] = 2;  // turn: the user may have changed it by the manager
  event.xclient.data.l[1] =
      static_cast<long>(XInternAtom(display, "_NET_WM_STATE_FULLSCREEN", False));
  event.xclient.data.l[3] = 1;  // of a program, not of a pager
  XSendEvent(display, DefaultRootWindow(display), False,
             SubstructureNotifyMask | SubstructureRedirectMask, &event);
  XFlush(display);
  return true;
}

void FullScreen::turn() {
  if (ask_manager()) return;
  is_full_ = !is_full_;
  if (is_full_) {
    const int *const place = window_->GetPosition(), *const size = window_->GetSize();
    before_ = {place[0], place[1], size[0], size[1]};
    const int* const display = window_->GetScreenSize();
    window_->SetPosition(0, 0);
    window_->SetSize(display[0], display[1]);
  } else {
    window_->SetPosition(before_[0], before_[1]);
    window_->SetSize(before_[2], before_[3]);
  }
}

}  // namespace tetwarp::view
