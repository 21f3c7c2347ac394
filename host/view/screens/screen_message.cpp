/// @file screen_message.cpp
/// A message is four letters, the number of its kind in the variant, and its members.
#include "host/view/screens/screen_message.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
constexpr std::array<char, 4> letters{'t', 'w', 's', '1'};

void write(ByteWriter& to, const JoinMessage& message) {
  to.add_text(message.screen);
  to.add(message.session);
}
void write(ByteWriter& to, const ReadyMessage& message) {
  to.add(message.frame);
}
void write(ByteWriter&, const AliveMessage&) {}
void write(ByteWriter&, const LeaveMessage&) {}
void write(ByteWriter& to, const HeadMessage& message) {
  to.add(message.head);
}
void write(ByteWriter& to, const WelcomeMessage& message) {
  const Screen& screen = message.screen;
  to.add(message.session);
  to.add_text(screen.name);
  to.add(screen.lower_left);
  to.add(screen.lower_right);
  to.add(screen.upper_right);
  to.add(screen.stereo);
  to.add(screen.window);
  to.add(static_cast<std::uint8_t>(screen.is_fullscreen));
  to.add(static_cast<std::uint8_t>(screen.has_border));
  to.add(message.wait);
  to.add_list(message.scene);
}
void write(ByteWriter& to, const RefuseMessage& message) {
  to.add_text(message.reason);
}
void write(ByteWriter& to, const FrameMessage& message) {
  to.add(message.session);
  to.add(message.frame);
  to.add(message.head);
  to.add(message.eye_separation);
  to.add(message.place);
  to.add(message.look.volumes);
  to.add(static_cast<std::uint8_t>(message.look.shows_contacts));
  to.add(message.look.level);
  to.add(message.look.width);
  to.add(static_cast<std::uint8_t>(message.look.cut.has_value()));
  to.add(message.look.cut.value_or(Cut{}));
  to.add_list(message.state);
}
void write(ByteWriter& to, const SwapMessage& message) {
  to.add(message.frame);
}
void write(ByteWriter&, const EndMessage&) {}
void write(ByteWriter&, const WhoMessage&) {}

HeadPose read_head(ByteReader& from) {
  const auto head = from.get<HeadPose>();
  double size = 0;
  for (const double part : head.rotation) size += part * part;
  require(is_in_world(head.position) && std::abs(size - 1) < 1e-3, "no pose of a head");
  return head;
}

WelcomeMessage read_welcome(ByteReader& from) {
  WelcomeMessage message;
  Screen& screen = message.screen;
  message.session = from.get<std::uint64_t>();
  screen.name = from.get_text();
  screen.lower_left = from.get<Point3>();
  screen.lower_right = from.get<Point3>();
  screen.upper_right = from.get<Point3>();
  screen.stereo = from.get<Stereo>();
  screen.window = from.get<std::array<std::int32_t, 4>>();
  screen.is_fullscreen = from.get_bool();
  screen.has_border = from.get_bool();
  message.wait = from.get<double>();
  message.scene = from.get_list<std::byte>();
  require(is_in_world(screen.lower_left) && is_in_world(screen.lower_right) &&
              is_in_world(screen.upper_right) && screen.stereo <= Stereo::right &&
              message.wait > 0 && message.wait <= 60,
          "no screen");
  for (std::size_t n = 0; n < 4; ++n) {
    const std::int32_t low = n < 2 ? -farthest_window : 0;
    const std::int32_t high = n < 2 ? farthest_window : largest_window;
    require(screen.window[n] >= low && screen.window[n] <= high, "no window");
  }
  return message;
}

FrameMessage read_frame(ByteReader& from) {
  FrameMessage message;
  message.session = from.get<std::uint64_t>();
  message.frame = from.get<std::uint64_t>();
  message.head = read_head(from);
  message.eye_separation = from.get<double>();
  message.place = from.get<RoomPlace>();
  message.look.volumes = from.get<std::uint8_t>();
  message.look.shows_contacts = from.get_bool();
  message.look.level = from.get<double>();
  message.look.width = from.get<double>();
  const bool is_cut = from.get_bool();
  const auto cut = from.get<Cut>();
  if (is_cut) message.look.cut = cut;
  message.state = from.get_list<std::byte>();
  const RoomPlace& place = message.place;
  require(is_in_world(place.observer) && is_in_world(place.origin) &&
              std::ranges::all_of(place.axes, is_in_world),
          "no place of the room");
  require(message.eye_separation >= 0 && message.eye_separation <= 1 && message.look.volumes <= 2 &&
              std::abs(message.look.level) < 1e6 && message.look.width > 1e-6 &&
              message.look.width < 1e6 && is_in_world(cut.point) &&
              std::abs(norm(cut.normal) - 1) < 1e-6,
          "no look");
  return message;
}

template <class Message>
Bytes written(const Message& message) {
  ByteWriter to;
  to.add(letters);
  to.add(static_cast<std::uint8_t>(message.index()));
  std::visit([&](const auto& kind) { write(to, kind); }, message);
  return to.take();
}

std::uint8_t read_kind(ByteReader& from) {
  using Letters = std::array<char, 4>;
  require(from.get<Letters>() == letters, "not of this program");
  return from.get<std::uint8_t>();
}
}  // namespace

Bytes bytes_of(const ToMaster& message) {
  return written(message);
}

Bytes bytes_of(const ToScreen& message) {
  return written(message);
}

ToMaster to_master(std::span<const std::byte> bytes) {
  ByteReader from(bytes);
  ToMaster message;
  switch (read_kind(from)) {
    case 0: {
      JoinMessage join;
      join.screen = from.get_text();
      join.session = from.get<std::uint64_t>();
      message = std::move(join);
      break;
    }
    case 1:
      message = ReadyMessage{from.get<std::uint64_t>()};
      break;
    case 2:
      message = AliveMessage{};
      break;
    case 3:
      message = LeaveMessage{};
      break;
    case 4:
      message = HeadMessage{read_head(from)};
      break;
    default:
      throw std::invalid_argument("no kind of message");
  }
  from.end();
  return message;
}

ToScreen to_screen(std::span<const std::byte> bytes) {
  ByteReader from(bytes);
  ToScreen message;
  switch (read_kind(from)) {
    case 0:
      message = read_welcome(from);
      break;
    case 1:
      message = RefuseMessage{from.get_text()};
      break;
    case 2:
      message = read_frame(from);
      break;
    case 3:
      message = SwapMessage{from.get<std::uint64_t>()};
      break;
    case 4:
      message = EndMessage{};
      break;
    case 5:
      message = WhoMessage{};
      break;
    default:
      throw std::invalid_argument("no kind of message");
  }
  from.end();
  return message;
}

}  // namespace tetwarp::view
