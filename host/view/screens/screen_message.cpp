/// @file screen_message.cpp
/// A message is four letters and the variant.
#include "host/view/screens/screen_message.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <type_traits>

#include "host/base/point3.hpp"

namespace tetwarp::view {

// Each of these functions writes with a ByteWriter and reads with a ByteReader.

template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, JoinMessage>
void exchange_members(Stream& stream, Value& message) {
  auto& [screen, session] = message;
  stream(screen, session);
}

/// Display and host are not needed where the screen is.
template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, Screen>
void exchange_members(Stream& stream, Value& screen) {
  auto& [name, lower_left, lower_right, upper_right, stereo, window, is_fullscreen, has_border,
         display, host] = screen;
  stream(name, lower_left, lower_right, upper_right, stereo, window, is_fullscreen, has_border);
}

template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, WelcomeMessage>
void exchange_members(Stream& stream, Value& message) {
  auto& [session, screen, wait, scene] = message;
  stream(session, screen, wait, scene);
}

template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, RefuseMessage>
void exchange_members(Stream& stream, Value& message) {
  stream(message.reason);
}

template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, FrameMessage>
void exchange_members(Stream& stream, Value& message) {
  auto& [session, frame, head, eye_separation, place, look, state] = message;
  auto& [volumes, shows_contacts, level, width, slices, cut, curve, rays] = look;
  auto& [places, alone] = slices;
  stream(session, frame, head, eye_separation, place, volumes, shows_contacts, level, width, places,
         alone, cut, curve, rays, state);
}

namespace {
constexpr std::array<char, 4> own_letters{'t', 'w', 's', '4'};
constexpr std::size_t most_curve_points = 64, most_rays = 64;

void check_head(const HeadPose& head) {
  double size = 0;
  for (const double part : head.rotation) size += part * part;
  require(is_in_world(head.position) && std::abs(size - 1) < 1e-3, "no pose of a head");
}

void check_message(const auto&) {}

void check_message(const HeadMessage& message) {
  check_head(message.head);
}

void check_message(const WelcomeMessage& message) {
  const Screen& screen = message.screen;
  require(is_in_world(screen.lower_left) && is_in_world(screen.lower_right) &&
              is_in_world(screen.upper_right) && screen.stereo <= Stereo::right &&
              message.wait > 0 && message.wait <= 60,
          "no screen");
  for (std::size_t n = 0; n < 4; ++n) {
    const std::int32_t low = n < 2 ? -farthest_window : 0;
    const std::int32_t high = n < 2 ? farthest_window : largest_window;
    require(screen.window[n] >= low && screen.window[n] <= high, "no window");
  }
}

/// Values and colors are shares, and values go from 0 to 1 without a fall.
void check_curve(const std::vector<ColorPoint>& curve) {
  if (curve.empty()) return;
  require(curve.size() >= 2 && curve.size() <= most_curve_points && curve.front().value == 0 &&
              curve.back().value == 1,
          "no curve");
  double before = 0;
  for (const auto& [value, color, opacity] : curve) {
    for (const double share : {value, color[0], color[1], color[2], opacity}) {
      require(share >= 0 && share <= 1, "no point of a curve");
    }
    require(value >= before, "points of a curve without order");
    before = value;
  }
}

void check_message(const FrameMessage& message) {
  check_head(message.head);
  const RoomPlace& place = message.place;
  require(is_in_world(place.observer) && is_in_world(place.origin) &&
              std::ranges::all_of(place.axes, is_in_world),
          "no place of the room");
  const ScreenLook& look = message.look;
  require(message.eye_separation >= 0 && message.eye_separation <= 1 && look.volumes <= 2 &&
              std::abs(look.level) < 1e6 && look.width > 1e-6 && look.width < 1e6,
          "no look");
  const auto is_share = [](double share) { return share >= 0 && share <= 1; };
  require(std::ranges::all_of(look.slices.places, is_share) && look.slices.alone.value_or(0) < 3,
          "no slices");
  check_curve(look.curve);
  require(
      !look.cut || (is_in_world(look.cut->point) && std::abs(norm(look.cut->normal) - 1) < 1e-6),
      "no cut");
  require(look.rays.size() <= most_rays, "too many rays");
  for (const auto& [from, to] : look.rays) {
    require(is_in_world(from) && is_in_world(to), "no ray");
  }
}

template <class Message>
Bytes written(const Message& message) {
  ByteWriter to;
  to(own_letters, message);
  return to.take();
}

template <class Message>
Message read(std::span<const std::byte> bytes) {
  ByteReader from(bytes);
  std::array<char, 4> letters{};
  from(letters);
  require(letters == own_letters, "not of this program");
  Message message;
  from(message);
  from.end();
  std::visit([](const auto& kind) { check_message(kind); }, message);
  return message;
}
}  // namespace

Bytes bytes_of(const ToMaster& message) {
  return written(message);
}

Bytes bytes_of(const ToScreen& message) {
  return written(message);
}

ToMaster to_master(std::span<const std::byte> bytes) {
  return read<ToMaster>(bytes);
}

ToScreen to_screen(std::span<const std::byte> bytes) {
  return read<ToScreen>(bytes);
}

}  // namespace tetwarp::view
