/// @file test_gamepad.cpp
/// Gamepads, by a virtual one of SDL.
#include <SDL.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "host/view/devices/gamepad.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

/// A gamepad that this process plays.
class VirtualPad {
 public:
  VirtualPad() {
    SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER);
    if (SDL_NumJoysticks() > 0) return;  // a real one is connected
    index_ = SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX,
                                       SDL_CONTROLLER_BUTTON_MAX, 0);
    if (index_ < 0) return;
    stick_ = SDL_JoystickOpen(index_);
    // Triggers rest at the lowest number.
    set(SDL_CONTROLLER_AXIS_TRIGGERLEFT, -32768);
    set(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, -32768);
  }
  VirtualPad(const VirtualPad&) = delete;
  VirtualPad& operator=(const VirtualPad&) = delete;
  ~VirtualPad() {
    detach();
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }
  bool is_usable() const { return stick_ != nullptr; }
  void set(SDL_GameControllerAxis axis, int value) {
    SDL_JoystickSetVirtualAxis(stick_, axis, static_cast<Sint16>(value));
  }
  void press(SDL_GameControllerButton button, bool is_down) {
    SDL_JoystickSetVirtualButton(stick_, button, is_down ? 1 : 0);
  }
  void detach() {
    if (stick_ == nullptr) return;
    SDL_JoystickClose(stick_);
    stick_ = nullptr;
    SDL_JoystickDetachVirtual(index_);
  }

 private:
  int index_ = -1;
  SDL_Joystick* stick_ = nullptr;
};

TEST(Gamepad, SticksAndButtonsMoveTurnAndGrab) {
  VirtualPad pad;
  if (!pad.is_usable()) GTEST_SKIP() << "a joystick is connected, or SDL makes no virtual one";
  const auto device = open_gamepad();
  EXPECT_EQ(device->read().value().state, DeviceState{});
  pad.set(SDL_CONTROLLER_AXIS_LEFTX, 32767);
  pad.set(SDL_CONTROLLER_AXIS_LEFTY, -32768);
  pad.set(SDL_CONTROLLER_AXIS_RIGHTX, 3000);  // it rests
  pad.set(SDL_CONTROLLER_AXIS_RIGHTY, 32767);
  pad.press(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  pad.press(SDL_CONTROLLER_BUTTON_A, true);
  const DeviceState pressed = device->read().value().state;
  EXPECT_EQ(pressed.move, (Point3{1, 1, -1}));
  EXPECT_EQ(pressed.turn[0], 1);
  EXPECT_EQ(pressed.turn[1], 0);
  EXPECT_TRUE(pressed.grabs);
  pad.press(SDL_CONTROLLER_BUTTON_A, false);
  pad.press(SDL_CONTROLLER_BUTTON_B, true);
  EXPECT_FALSE(device->read().value().state.grabs);
  EXPECT_TRUE(device->read().value().state.probes);
  EXPECT_EQ(device->problem(), "");
  pad.detach();
  EXPECT_FALSE(device->read());
  EXPECT_EQ(device->problem(), "gamepad: is gone");
}

TEST(Gamepad, ThatIsMissingIsNamed) {
  try {
    open_gamepad();
    GTEST_SKIP() << "a gamepad is connected";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "gamepad: none is connected");
  }
}

}  // namespace
}  // namespace tetwarp::test
