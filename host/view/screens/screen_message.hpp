/// @file screen_message.hpp
/// Messages between the master, which simulates, and the processes of screens.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "host/view/look/slice_look.hpp"
#include "host/view/pick.hpp"
#include "host/view/screens/message_bytes.hpp"
#include "host/view/screens/room.hpp"
#include "host/view/volume_colors.hpp"

namespace tetwarp::view {

// ---- to the master
struct JoinMessage {
  std::string screen;
  std::uint64_t session = 0;  ///< whose scene the sender has; 0: none
};
/// A frame is drawn and waits for the swap.
struct ReadyMessage {
  std::uint64_t frame = 0;
};
struct AliveMessage {};
struct LeaveMessage {};
/// Of a tracker.
struct HeadMessage {
  HeadPose head;
};
using ToMaster = std::variant<JoinMessage, ReadyMessage, AliveMessage, LeaveMessage, HeadMessage>;

// ---- to screens
struct WelcomeMessage {
  std::uint64_t session = 0;  ///< of this run of the master
  Screen screen;
  double wait = 0;  ///< Room::wait [s]
  Bytes scene;      ///< of a SharedScene; empty: the receiver has it
};
struct RefuseMessage {
  std::string reason;
};
/// What the user of the master chose to see.
struct ScreenLook {
  std::uint8_t volumes = 0;  ///< rays, slices or surfaces, as VolumeLook
  bool shows_contacts = true;
  double level = 0, width = 1;  ///< as VolumeColors::set_window()
  SliceLook slices = {};
  std::optional<Cut> cut = {};
  std::vector<ColorPoint> curve = {};  ///< as VolumeColors::set_curve(); empty: nobody changed it
  std::vector<WandRay> rays = {};      ///< of wands

  bool operator==(const ScreenLook&) const = default;
};
struct FrameMessage {
  std::uint64_t session = 0, frame = 0;
  HeadPose head;
  double eye_separation = 0;
  RoomPlace place;
  ScreenLook look;
  Bytes state;  ///< of a SharedState
};
struct SwapMessage {
  std::uint64_t frame = 0;
};
/// The master ends.
struct EndMessage {};
/// The master has no screen at this address: the process must send a JoinMessage.
struct WhoMessage {};
using ToScreen =
    std::variant<WelcomeMessage, RefuseMessage, FrameMessage, SwapMessage, EndMessage, WhoMessage>;

Bytes bytes_of(const ToMaster& message);
Bytes bytes_of(const ToScreen& message);

// Scene and state within a message are checked by scene_of() and state_of().
/// @throws std::invalid_argument  the bytes are not such a message
ToMaster to_master(std::span<const std::byte> bytes);
ToScreen to_screen(std::span<const std::byte> bytes);

}  // namespace tetwarp::view
