/// @file gamepad_sdl.cpp
/// Sticks and buttons by SDL's names, which are those of an Xbox.
#include <SDL.h>

#include <algorithm>
#include <stdexcept>

#include "host/base/stopwatch.hpp"
#include "host/view/devices/gamepad.hpp"

namespace tetwarp::view {
namespace {
class Gamepad : public InputDevice {
 public:
  Gamepad() {
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0) {
      throw std::runtime_error(std::string("gamepad: ") + SDL_GetError());
    }
    for (int n = 0; n < SDL_NumJoysticks() && pad_ == nullptr; ++n) {
      if (SDL_IsGameController(n) == SDL_TRUE) pad_ = SDL_GameControllerOpen(n);
    }
    if (pad_ == nullptr) {
      SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
      throw std::runtime_error("gamepad: none is connected");
    }
  }
  Gamepad(const Gamepad&) = delete;
  Gamepad& operator=(const Gamepad&) = delete;
  ~Gamepad() override {
    SDL_GameControllerClose(pad_);
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }

  std::optional<DeviceSpan> read() override {
    SDL_GameControllerUpdate();
    if (SDL_GameControllerGetAttached(pad_) == SDL_FALSE) return std::nullopt;
    DeviceSpan span;
    const double lifts =
        button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER) - button(SDL_CONTROLLER_BUTTON_LEFTSHOULDER);
    span.state.move = {axis(SDL_CONTROLLER_AXIS_LEFTX), lifts, axis(SDL_CONTROLLER_AXIS_LEFTY)};
    span.state.turn = {
        axis(SDL_CONTROLLER_AXIS_RIGHTY), axis(SDL_CONTROLLER_AXIS_RIGHTX),
        axis(SDL_CONTROLLER_AXIS_TRIGGERLEFT) - axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT)};
    span.state.grabs = button(SDL_CONTROLLER_BUTTON_A) > 0;
    span.state.probes = button(SDL_CONTROLLER_BUTTON_B) > 0;
    span.seconds = std::min(since_.seconds(), most_span);
    since_ = {};
    return span;
  }
  std::string problem() const override {
    return SDL_GameControllerGetAttached(pad_) == SDL_TRUE ? "" : "gamepad: is gone";
  }

 private:
  double button(SDL_GameControllerButton of) const { return SDL_GameControllerGetButton(pad_, of); }
  /// -1 to 1, and 0 where a stick rests.
  double axis(SDL_GameControllerAxis of) const {
    return beyond_rest(SDL_GameControllerGetAxis(pad_, of) / 32767.0);
  }

  SDL_GameController* pad_ = nullptr;
  Stopwatch since_;
};
}  // namespace

std::unique_ptr<InputDevice> open_gamepad() {
  return std::make_unique<Gamepad>();
}

}  // namespace tetwarp::view
