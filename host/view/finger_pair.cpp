/// @file finger_pair.cpp
/// A handle whose anchor goes with the outer finger.
#include "host/view/finger_pair.hpp"

#include <cmath>

#include "host/base/point3.hpp"
#include "host/view/view_tools.hpp"

namespace tetwarp::view {
namespace {
constexpr const char* spring_name = "skin";
}  // namespace

FingerPair::FingerPair(Simulator& simulator, const ViewOptions& options) : simulator_(simulator) {
  if (!options.fingers) return;
  const std::vector<Body>& bodies = simulator.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].name == outer_finger) outer_ = b;
    if (bodies[b].name == inner_finger) inner_ = b;
  }
  start_ = bodies[inner_.value()].pose.position;
  PointHandle spring{.name = spring_name, .body = inner_finger, .center = start_};
  spring.stiffness = options.skin_stiffness;
  spring.damping = 2 * std::sqrt(spring.stiffness * simulator.body(*inner_).mass);  // critical
  simulator.add_handle(spring);
}

void FingerPair::follow(std::size_t body, const Point3& displacement) {
  if (body != outer_) return;
  displacement_ = displacement;
  simulator_.move_handle(spring_name, displacement);
}

void FingerPair::reset(const BodyCarrier& carrier) {
  if (outer_) displacement_ = carrier.displacement(*outer_);
}

std::optional<GrabView> FingerPair::view(const StepRecord& record,
                                         const std::optional<std::size_t>& carried) const {
  if (!inner_ || (carried && carried != outer_)) return std::nullopt;
  const Point3 force = record.bodies[*inner_].handle_force;
  return GrabView{record.bodies[*inner_].center, plus(start_, displacement_), force};
}

}  // namespace tetwarp::view
