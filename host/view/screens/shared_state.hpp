/// @file shared_state.hpp
/// SharedState: what moves the bodies of a SharedScene, for one moment of a simulation.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/view/live_frame.hpp"
#include "host/view/screens/shared_scene.hpp"

namespace tetwarp::view {

using Float3 = std::array<float, 3>;

struct SharedState {
  std::int64_t step = 0;
  double time = 0;  ///< [s]
  bool is_paused = false;
  std::vector<std::vector<Float3>> moving;      ///< [bodies][moving_count] [m]
  std::vector<std::array<Float3, 2>> contacts;  ///< place [m], force [N]
  std::optional<std::array<Float3, 2>> grab;    ///< point, target [m]
  SurfaceQuantity quantity = SurfaceQuantity::none;
  std::array<float, 2> range{};                   ///< of the quantity so far
  std::vector<std::vector<std::uint8_t>> levels;  ///< [bodies][points] of it; empty: none
};

/// Of a value without color.
inline constexpr std::uint8_t no_level = 255;

/// Values as shares of a range in steps of 1/254 of it.
std::vector<std::vector<std::uint8_t>> levels_of(const std::vector<std::vector<float>>& values,
                                                 const ValueRange& range);

Bytes bytes_of(const SharedState& state);

/// @throws std::invalid_argument  the bytes are no state of this scene
SharedState state_of(std::span<const std::byte> bytes, const SharedScene& scene);

/// Where the nodes of a body of form nodes are.
std::vector<Point3> nodes_of(const SharedState& state, std::size_t body);

/// What a window draws of it, without volumes.
void set_frame(const SharedScene& scene, const SharedState& state, LiveFrame& frame);

}  // namespace tetwarp::view
