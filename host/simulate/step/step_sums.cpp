/// @file step_sums.cpp
/// Sums impulses of contacts, springs and loads on each body.
#include "host/simulate/step/step_sums.hpp"
#include "host/base/index_of.hpp"

#include "host/simulate/model/body_points.hpp"
#include "host/simulate/model/rotations.hpp"

namespace tetwarp {
namespace {

void add_to(Point3& sum, const Point3& x) {
  sum = plus(sum, x);
}

/// Velocity of a point by the velocities of blocks, its lever that of the start of the step.
Point3 velocity_of(const ModelPoint& point,
                   const Model& model,
                   const ModelState& before,
                   const std::vector<Point3>& velocity) {
  if (point.rigid >= 0) {
    const auto block = index_of(model.node_count + 2 * point.rigid);
    const Point3 lever = rotate(at(before.rotation, point.rigid), point.local);
    return plus(velocity[block], cross(velocity[block + 1], lever));
  }
  Point3 sum{0, 0, 0};
  for (std::size_t a = 0; a < 4 && point.node[a] >= 0; ++a) {
    add_to(sum, times(point.weight[a], at(velocity, point.node[a])));
  }
  return sum;
}

void add_springs(const Model& model,
                 const ModelState& before,
                 const ModelState& after,
                 const StepInput& input,
                 StepSums& sums) {
  const ModelSprings& springs = model.springs;
  const double dt = input.time_step;
  for (std::size_t s = 0; s < springs.a.size(); ++s) {
    if (input.is_active[s] == 0) continue;
    const ModelPoint &a = springs.a[s], &b = springs.b[s];
    const bool has_anchor = springs.handle[s] >= 0;
    const Point3 p_a = position_of(a, before, model.node_count);
    const Point3 v_a = velocity_of(a, model, before, after.velocity);
    const double k = springs.stiffness[s], c = springs.damping[s];
    Point3 impulse;
    if (has_anchor) {
      // -dt k (p_a + dt v_a - anchor) - dt c (v_a - v_anchor)
      const Point3 stretch = plus(minus(p_a, input.anchor[s]), times(dt, v_a));
      const Point3 drag = minus(v_a, input.anchor_velocity[s]);
      impulse = times(-dt, plus(times(k, stretch), times(c, drag)));
      sums.work += dot(impulse, input.anchor_velocity[s]);
    } else {
      const Point3 v = minus(v_a, velocity_of(b, model, before, after.velocity));
      const Point3 stretch =
          plus(minus(p_a, position_of(b, before, model.node_count)), times(dt, v));
      impulse = times(-dt, plus(times(k, stretch), times(c, v)));
    }
    auto& of_bodies = has_anchor ? sums.handle : sums.coupling;
    const std::size_t body_count = of_bodies.size();
    if (a.body >= 0 && index_of(a.body) < body_count) {
      add_to(of_bodies[index_of(a.body)], impulse);
    }
    if (has_anchor) continue;
    if (b.body >= 0 && index_of(b.body) < body_count) {
      add_to(of_bodies[index_of(b.body)], times(-1, impulse));
    }
    if (springs.coupling[s] >= 0) add_to(sums.on_a[index_of(springs.coupling[s])], impulse);
  }
}

}  // namespace

void StepSums::reset(std::size_t body_count,
                     std::size_t obstacle_count,
                     std::size_t coupling_count) {
  for (auto* list : {&support, &handle, &coupling, &load, &contact}) {
    list->assign(body_count, {0, 0, 0});
  }
  obstacle.assign(obstacle_count, {0, 0, 0});
  on_a.assign(coupling_count, {0, 0, 0});
  work = 0;
}

void StepSums::add_contacts(const std::vector<Point3>& on_bodies) {
  for (std::size_t b = 0; b < on_bodies.size(); ++b) {
    add_to(b < contact.size() ? contact[b] : obstacle[b - contact.size()], on_bodies[b]);
  }
}

void add_step(const Model& model,
              const ModelState& before,
              const ModelState& after,
              const StepInput& input,
              const std::vector<Point3>& supports,
              StepSums& sums) {
  const double dt = input.time_step;
  const auto add_block = [&](std::size_t body, std::size_t block, bool is_linear) {
    const Point3 load = times(dt, input.block_force[block]);
    if (is_linear && body < sums.support.size()) {
      add_to(sums.support[body], supports[block]);
      add_to(sums.load[body], load);
    }
    sums.work += dot(plus(supports[block], load), after.velocity[block]);
  };
  for (std::size_t b = 0; b < sums.support.size(); ++b) {
    const auto end = index_of(model.body_node[b + 1]);
    for (auto n = index_of(model.body_node[b]); n < end; ++n) add_block(b, n, true);
  }
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    const auto block = index_of(model.node_count + 2 * r);
    const auto body = index_of(at(model.rigid.body, r));
    add_block(body, block, true);
    add_block(body, block + 1, false);
  }
  add_springs(model, before, after, input, sums);
}

}  // namespace tetwarp
