/// @file shared_state.cpp
/// States as bytes, and the points of surfaces that follow from them.
#include "host/view/screens/shared_state.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <type_traits>

#include "host/base/point3.hpp"

namespace tetwarp::view {

/// Writes with a ByteWriter and reads with a ByteReader.
template <class Stream, class Value>
requires std::same_as<std::remove_const_t<Value>, SharedState>
void exchange_members(Stream& stream, Value& state) {
  auto& [step, time, is_paused, moving, contacts, grab, quantity, range, levels] = state;
  stream(step, time, is_paused, moving, contacts, grab, quantity, range, levels);
}

namespace {
Point3 wide(const Float3& x) {
  return {x[0], x[1], x[2]};
}

bool is_finite_float(const Float3& x) {
  return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
}

std::vector<Point3> surface_of_body(const SharedBody& body, const std::vector<Float3>& moving) {
  std::vector<Point3> points;
  if (body.form == BodyForm::nodes) {
    for (std::size_t p = 0; p < body.nodes.size(); ++p) {
      Point3 sum{};
      for (std::size_t n = 0; n < 4; ++n) {
        const auto node = static_cast<std::size_t>(body.nodes[p][n]);
        sum = plus(sum, times(body.weights[p][n], wide(moving[node])));
      }
      points.push_back(sum);
    }
  } else if (body.form == BodyForm::pose) {
    for (const Point3& rest : body.rest_points) {
      Point3 sum = wide(moving[0]);
      for (std::size_t a = 0; a < 3; ++a) sum = plus(sum, times(rest[a], wide(moving[a + 1])));
      points.push_back(sum);
    }
  } else {
    for (const Float3& x : moving) points.push_back(wide(x));
  }
  return points;
}
/// Values and their range, of which the levels are shares.
void set_values(const SharedState& state, LiveFrame& frame) {
  const auto [low, high] = state.range;
  frame.quantity = state.quantity;
  frame.range = ValueRange(low, high);
  frame.values.clear();
  for (const std::vector<std::uint8_t>& of_body : state.levels) {
    auto& values = frame.values.emplace_back();
    for (const std::uint8_t level : of_body) {
      const float share = static_cast<float>(level) / 254;
      values.push_back(level == no_level ? NAN : low + share * (high - low));
    }
  }
}
}  // namespace

std::vector<std::vector<std::uint8_t>> levels_of(const std::vector<std::vector<float>>& values,
                                                 const ValueRange& range) {
  std::vector<std::vector<std::uint8_t>> levels;
  for (const std::vector<float>& of_body : values) {
    auto& of_points = levels.emplace_back();
    for (const float value : of_body) {
      const double share = std::clamp(range.share(value), 0.0, 1.0);
      of_points.push_back(std::isnan(value) ? no_level
                                            : static_cast<std::uint8_t>(std::lround(254 * share)));
    }
  }
  return levels;
}

Bytes bytes_of(const SharedState& state) {
  return bytes_of_values(state);
}

SharedState state_of(std::span<const std::byte> bytes, const SharedScene& scene) {
  auto state = read_values<SharedState>(bytes);
  require(std::isfinite(state.time) && state.moving.size() == scene.bodies.size(),
          "no state of this scene");
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    require(state.moving[b].size() == static_cast<std::size_t>(scene.bodies[b].moving_count) &&
                std::ranges::all_of(state.moving[b], is_finite_float),
            "no state of this scene");
  }
  require(state.quantity <= SurfaceQuantity::adhesion && std::isfinite(state.range[0]) &&
              std::isfinite(state.range[1]) && state.range[0] <= state.range[1],
          "no colors of this scene");
  require(state.levels.empty() || state.levels.size() == scene.bodies.size(),
          "no colors of this scene");
  for (std::size_t b = 0; b < state.levels.size(); ++b) {
    require(state.levels[b].size() == point_count(scene.bodies[b]), "no colors of this scene");
  }
  const auto are_finite = [](const std::array<Float3, 2>& pair) {
    return is_finite_float(pair[0]) && is_finite_float(pair[1]);
  };
  require(
      std::ranges::all_of(state.contacts, are_finite) && (!state.grab || are_finite(*state.grab)),
      "a number that is not finite");
  return state;
}

std::vector<Point3> nodes_of(const SharedState& state, std::size_t body) {
  std::vector<Point3> nodes;
  for (const Float3& x : state.moving[body]) nodes.push_back(wide(x));
  return nodes;
}

void set_frame(const SharedScene& scene, const SharedState& state, LiveFrame& frame) {
  frame.step = state.step;
  frame.time = state.time;
  frame.is_paused = state.is_paused;
  frame.points.resize(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    frame.points[b] = surface_of_body(scene.bodies[b], state.moving[b]);
  }
  frame.contacts.clear();
  for (const auto& [place, force] : state.contacts) {
    frame.contacts.push_back({wide(place), wide(force)});
  }
  frame.grab.reset();
  if (state.grab) frame.grab = GrabView{wide((*state.grab)[0]), wide((*state.grab)[1]), {}};
  set_values(state, frame);
}

}  // namespace tetwarp::view
