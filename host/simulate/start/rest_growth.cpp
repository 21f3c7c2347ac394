/// @file rest_growth.cpp
/// Forces of elements whose rest shapes are smaller, and velocities of prescribed nodes.
#include "host/simulate/start/rest_growth.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {
namespace {

void add_to(std::vector<Point3>& list, std::int32_t index, const Point3& x) {
  Point3& entry = list[index_of(index)];
  entry = plus(entry, x);
}

}  // namespace

RestGrowth::RestGrowth(const SceneGeometry& geometry,
                       const Model& model,
                       const std::vector<Point3>& full_start,
                       const std::vector<ShrunkBody>& bodies)
    : full_start_(full_start) {
  for (const ShrunkBody& shrunk : bodies) {
    GrowingBody& body = bodies_.emplace_back();
    body.shrunk = shrunk;
    const std::int32_t first = at(model.body_node, shrunk.body);
    const std::int32_t end = at(model.body_node, shrunk.body + 1);
    const auto is_own = [&](std::int32_t node) { return node >= first && node < end; };
    for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
      if (is_own(model.tets.nodes[t][0])) body.tets.push_back(static_cast<std::int32_t>(t));
    }
    for (std::size_t e = 0; e < model.edges.nodes.size(); ++e) {
      if (is_own(model.edges.nodes[e][0])) body.edges.push_back(static_cast<std::int32_t>(e));
    }
    const BodyGeometry& of = geometry.bodies[index_of(shrunk.body)];
    for (const std::int32_t n : of.fixed) body.fixed.push_back(first + n);
    for (const DrivenGroup& group : of.driven) {
      for (const std::int32_t n : group.nodes) body.driven.push_back(first + n);
    }
  }
}

void RestGrowth::add_forces(const GrowingBody& body,
                            double scale,
                            const Model& model,
                            const ModelState& state,
                            std::vector<Point3>& force) const {
  for (const std::int32_t t : body.tets) {
    const auto& nodes = at(model.tets.nodes, t);
    double x[12], f[9], r[9], turned[3];
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t d = 0; d < 3; ++d) x[3 * a + d] = at(state.position, nodes[a])[d];
    }
    const double* const gradient = at(model.tets.gradient, t).data();
    deformation_gradient(x, gradient, f);
    tet_rotation(f, r);
    const double stress = (2 * at(model.tets.mu, t) + 3 * at(model.tets.lambda, t)) * (1 - scale);
    const double size = -at(model.tets.volume, t) * stress;
    for (std::size_t a = 1; a < 4; ++a) {
      multiply3(r, gradient + 3 * (a - 1), turned);
      const Point3 pull{size * turned[0], size * turned[1], size * turned[2]};
      add_to(force, nodes[a], pull);
      add_to(force, nodes[0], times(-1, pull));
    }
  }
  for (const std::int32_t e : body.edges) {
    const auto [a, b] = at(model.edges.nodes, e);
    const double tension =
        at(model.edges.stiffness, e) * (1 - scale) * at(model.edges.rest_length, e);
    const Point3 pull = times(tension, unit(minus(at(state.position, b), at(state.position, a))));
    add_to(force, a, pull);
    add_to(force, b, times(-1, pull));
  }
}

void RestGrowth::apply(const Model& model, const ModelState& state, StepInput& input) const {
  const double part = std::min(input.end_time / duration, 1.0);
  for (const GrowingBody& body : bodies_) {
    const Point3& center = body.shrunk.center;
    const double scale = body.shrunk.scale + (1 - body.shrunk.scale) * part;
    if (scale < 1) add_forces(body, scale, model, state, input.block_force);
    const auto head_for = [&](std::int32_t node, const Point3& full) {
      const Point3 target = scale < 1 ? plus(center, times(scale, minus(full, center))) : full;
      input.prescribed_velocity[index_of(node)] =
          times(1 / input.time_step, minus(target, at(state.position, node)));
    };
    for (const std::int32_t node : body.fixed) head_for(node, at(full_start_, node));
    for (const std::int32_t node : body.driven) {
      const Point3 way = times(input.time_step, at(input.prescribed_velocity, node));
      head_for(node, plus(at(state.position, node), way));
    }
  }
}

}  // namespace tetwarp
