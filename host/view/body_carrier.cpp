/// @file body_carrier.cpp
/// Displacements of scripted bodies.
#include "host/view/body_carrier.hpp"

#include <variant>

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
constexpr double most_speed = 5;  // sizes of the body a second
}  // namespace

BodyCarrier::BodyCarrier(const Simulator& simulator)
    : simulator_(simulator), displacements_(simulator.scene().bodies.size()) {
  for (std::size_t b = 0; b < displacements_.size(); ++b) starts_.push_back(first_point(b));
}

Point3 BodyCarrier::first_point(std::size_t body) const {
  if (!may_carry(body)) return {0, 0, 0};
  const std::vector<Point3> points = simulator_.surface_positions(body);
  return points.empty() ? Point3{0, 0, 0} : points.front();
}

bool BodyCarrier::may_carry(std::size_t body) const {
  return simulator_.scene().bodies[body].kind == BodyKind::scripted;
}

std::string BodyCarrier::take_up(std::size_t body, const Point3& point) {
  const bool has_script =
      !std::holds_alternative<std::monostate>(simulator_.scene().bodies[body].motion);
  if (has_script) return simulator_.scene().bodies[body].name + " follows its script";
  const Point3& home = displacements_[body];
  held_ = Held{body, point, home, home};
  return {};
}

void BodyCarrier::pull(const Point3& point) {
  if (held_) held_->target = plus(held_->home, minus(point, held_->start));
}

void BodyCarrier::reset() {
  held_.reset();
  for (std::size_t b = 0; b < displacements_.size(); ++b) {
    displacements_[b] = minus(first_point(b), starts_[b]);
  }
}

std::optional<BodyCarrier::Way> BodyCarrier::next() const {
  if (!held_ || displacements_[held_->body] == held_->target) return std::nullopt;
  const Point3& now = displacements_[held_->body];
  const Point3 way = minus(held_->target, now);
  const Bounds bounds = bounds_of(simulator_.surface_positions(held_->body));
  const double size = norm(minus(bounds.high, bounds.low));
  const double most = most_speed * size * simulator_.scene().time_step;
  if (norm(way) <= most) return Way{held_->body, held_->target};
  return Way{held_->body, plus(now, times(most / norm(way), way))};
}

std::optional<GrabView> BodyCarrier::view(const std::vector<ContactPoint>& contacts,
                                          double seconds) const {
  if (!held_) return std::nullopt;
  Point3 force{};
  for (const ContactPoint& contact : contacts) {
    if (contact.body_a == held_->body) force = plus(force, times(1 / seconds, contact.impulse));
    if (contact.body_b == held_->body) force = minus(force, times(1 / seconds, contact.impulse));
  }
  const Point3 moved = minus(displacements_[held_->body], held_->home);
  return GrabView{plus(held_->start, moved), plus(held_->start, minus(held_->target, held_->home)),
                  force};
}

}  // namespace tetwarp::view
