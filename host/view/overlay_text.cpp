/// @file overlay_text.cpp
/// Numbers of a moment, and of a place.
#include "host/view/overlay_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "host/base/point3.hpp"

namespace tetwarp::view {

std::string overlay_text(const ViewScene& scene, const LiveFrame& frame, std::size_t pictures) {
  std::string text = fmt::format("step {}   {:.3f} s{}\n{:.0f} steps/s   {} frames/s   {} contacts",
                                 frame.step, frame.time, frame.is_paused ? "   paused" : "",
                                 frame.steps_per_second, pictures, frame.contacts.size());
  if (std::isfinite(scene.max_step_seconds)) {
    text += fmt::format("\nbudget {:.3g} ms, over in {} of {} steps", 1000 * scene.max_step_seconds,
                        frame.late_steps, frame.tick);
  } else if (!frame.is_converged) {
    text += "\nabove its tolerance";
  }
  if (frame.grab) text += fmt::format("\nforce {:.3g} N", norm(frame.grab->force));
  if (!frame.message.empty()) text += "\n" + frame.message;
  return text;
}

std::string probe_text(const ViewScene& scene,
                       const LiveFrame& frame,
                       const Pick& found,
                       const Point3& ray) {
  const Point3& x = found.point;
  std::string text =
      fmt::format("{} at {:.4g}, {:.4g}, {:.4g} m", scene.bodies[found.body], x[0], x[1], x[2]);
  for (std::size_t v = 0; v < frame.volumes.size(); ++v) {
    if (scene.volumes[v].body != found.body) continue;
    const Point3 below = plus(x, times(frame.volumes[v].grid.spacing[0], unit(ray)));
    const auto value = value_at(frame.volumes[v], scene.volumes[v], below);
    if (value) text += fmt::format(": {:.4g}", *value);
  }
  return text;
}

}  // namespace tetwarp::view
