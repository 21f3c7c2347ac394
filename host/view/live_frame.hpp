/// @file live_frame.hpp
/// What the window draws of one moment of a simulation.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/view/input_delay.hpp"
#include "host/view/look/value_colors.hpp"

namespace tetwarp::view {

/// Values of a volume are mapped linearly: `low` is 0 in the samples, `high` the largest.
inline constexpr std::int16_t largest_sample = 32767;

/// A warped volume.
struct VolumeFrame {
  Grid grid;  ///< without a direction
  std::vector<std::int16_t> samples;
};

struct ContactArrow {
  Point3 position{};  ///< [m]
  Point3 force{};     ///< on the first body [N]
};

/// A point of a body that the mouse holds.
struct GrabView {
  Point3 point{}, target{};  ///< [m]
  Point3 force{};  ///< of all handles on the body, or of all contacts if it is carried [N]
};

struct LiveFrame {
  std::int64_t step = 0, tick = 0;  ///< of the scene; made in all
  double time = 0;                  ///< [s]
  std::vector<std::vector<Point3>>
      points;                        ///< [bodies] of what is drawn, world; empty: of a failure
  std::vector<VolumeFrame> volumes;  ///< [volumes], empty: not warped
  SurfaceQuantity quantity = SurfaceQuantity::none;
  std::vector<std::vector<float>> values;  ///< as SurfaceValues::of()
  ValueRange range;                        ///< of the values so far
  std::vector<ContactArrow> contacts;
  std::optional<GrabView> grab;
  std::optional<InputTime> input;  ///< of the newest pull that a step has followed
  bool is_paused = false, is_converged = true;
  bool is_last = false;  ///< no more follow
  double steps_per_second = 0;
  std::int64_t late_steps = 0;  ///< that max_step_seconds ended
  std::string message;          ///< an error, or empty
  bool has_failed = false;      ///< the simulation cannot go on from here
};

}  // namespace tetwarp::view
