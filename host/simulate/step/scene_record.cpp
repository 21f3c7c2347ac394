/// @file scene_record.cpp
/// Sums over nodes, rigid bodies and springs.
#include "host/simulate/step/scene_record.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/index_of.hpp"
#include "host/simulate/model/body_points.hpp"
#include "host/simulate/model/rotations.hpp"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {
namespace {

double spring_energy(const Model& model,
                     const ModelState& state,
                     const std::vector<std::optional<Point3>>& handles) {
  double energy = 0;
  const ModelEdges& edges = model.edges;
  for (std::size_t e = 0; e < edges.nodes.size(); ++e) {
    const Point3 line =
        minus(at(state.position, edges.nodes[e][1]), at(state.position, edges.nodes[e][0]));
    const double stretch = norm(line) - edges.rest_length[e];
    energy += edges.stiffness[e] * stretch * stretch / 2;
  }
  const ModelSprings& springs = model.springs;
  for (std::size_t s = 0; s < springs.a.size(); ++s) {
    Point3 end = position_of(springs.b[s], state, model.node_count);
    if (springs.handle[s] >= 0) {
      const auto& displacement = handles[index_of(springs.handle[s])];
      if (!displacement) continue;
      end = plus(end, *displacement);
    }
    const Point3 line = minus(position_of(springs.a[s], state, model.node_count), end);
    energy += springs.stiffness[s] * dot(line, line) / 2;
  }
  return energy;
}

/// Centers, then what the blocks of masses add: kinetic energy, angular momenta, bending.
void record_nodes(const Model& model, const ModelState& state, StepRecord& record) {
  const std::size_t body_count = record.bodies.size();
  std::vector<double> mass(body_count, 0);
  for (std::size_t b = 0; b < body_count; ++b) {
    BodyRecord& body = record.bodies[b];
    const auto begin = index_of(model.body_node[b]), end = index_of(model.body_node[b + 1]);
    double sum = 0;
    for (std::size_t n = begin; n < end; ++n) mass[b] += model.node_mass[n];
    for (std::size_t n = begin; n < end; ++n) {
      const double weight = mass[b] > 0 ? model.node_mass[n] : 1;  // scripted: the mean of nodes
      sum += weight;
      body.center = plus(body.center, times(weight, state.position[n]));
      body.velocity = plus(body.velocity, times(weight, state.velocity[n]));
    }
    if (begin == end) continue;
    body.center = times(1 / sum, body.center);
    body.velocity = times(1 / sum, body.velocity);
    record.momentum = plus(record.momentum, times(mass[b], body.velocity));
  }
  const ModelScalarBlocks& blocks = model.scalar_blocks;
  std::size_t b = 0;
  for (std::size_t k = 0; k < blocks.nodes.size(); ++k) {
    const auto [i, j] = blocks.nodes[k];
    while (i >= model.body_node[b + 1]) ++b;
    BodyRecord& body = record.bodies[b];
    const Point3 arm = minus(at(state.position, i), body.center);
    const Point3 momentum = times(blocks.mass[k], at(state.velocity, j));
    record.energy.kinetic += dot(at(state.velocity, i), momentum) / 2;
    body.angular_momentum = plus(body.angular_momentum, cross(arm, momentum));
    if (i == j || blocks.bend[k] == 0) continue;
    // Rows sum to 0: sum_ij B_ij x_i x_j / 2 = -sum_ij B_ij (x_i - x_j)^2 / 4.
    const Point3 line = minus(at(state.position, i), at(state.position, j));
    record.energy.elastic -= blocks.bend[k] * dot(line, line) / 4;
  }
  for (std::size_t of = 0; of < body_count; ++of) {
    const BodyRecord& body = record.bodies[of];
    if (!(mass[of] > 0)) continue;
    const Point3 orbital = times(mass[of], cross(body.center, body.velocity));
    record.angular_momentum = plus(record.angular_momentum, plus(body.angular_momentum, orbital));
  }
}

void record_rigid(const Model& model, const ModelState& state, StepRecord& record) {
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    const auto b = index_of(at(model.rigid.body, r));
    if (b >= record.bodies.size()) continue;
    BodyRecord& body = record.bodies[b];
    const double mass = at(model.rigid.mass, r);
    body.center = at(state.position, model.node_count + r);
    body.velocity = at(state.velocity, model.node_count + 2 * r);
    body.angular_momentum = at(state.angular_momentum, r);
    body.angular_velocity = angular_velocity_of(model, state, r);
    body.rotation = normalized(product(at(state.rotation, r), conjugate(at(model.rigid.axes, r))));
    if (!(mass > 0)) continue;
    const Point3 momentum = times(mass, body.velocity);
    record.energy.kinetic +=
        dot(momentum, body.velocity) / 2 + dot(body.angular_momentum, body.angular_velocity) / 2;
    record.momentum = plus(record.momentum, momentum);
    record.angular_momentum =
        plus(record.angular_momentum, plus(body.angular_momentum, cross(body.center, momentum)));
  }
}

}  // namespace

bool is_finite_state(const ModelState& state) {
  const auto all = [](const std::vector<Point3>& list) {
    return std::all_of(list.begin(), list.end(), [](const Point3& x) { return is_finite(x); });
  };
  const auto is_turn = [](const Quaternion& q) { return std::isfinite(q[0] + q[1] + q[2] + q[3]); };
  return all(state.position) && all(state.velocity) && all(state.angular_momentum) &&
         std::all_of(state.rotation.begin(), state.rotation.end(), is_turn);
}

std::int64_t inverted_count(const Model& model, const ModelState& state) {
  std::int64_t count = 0;
  for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
    double x[12], f[9], cofactors[3];
    double* next = x;
    for (const std::int32_t n : model.tets.nodes[t]) {
      next = std::ranges::copy(at(state.position, n), next).out;
    }
    deformation_gradient(x, model.tets.gradient[t].data(), f);
    cross3(f + 3, f + 6, cofactors);
    count += dot3(f, cofactors) < 0;
  }
  return count;
}

Point3 angular_velocity_of(const Model& model, const ModelState& state, std::int32_t rigid) {
  const Quaternion& turn = at(state.rotation, rigid);
  Point3 spin = rotate(conjugate(turn), at(state.angular_momentum, rigid));
  for (std::size_t d = 0; d < 3; ++d) {
    const double moment = at(model.rigid.inertia, rigid)[d];
    spin[d] = moment > 0 ? spin[d] / moment : 0;
  }
  return rotate(turn, spin);
}

void record_state(const Model& model,
                  const ModelState& state,
                  const Point3& gravity,
                  const std::vector<std::optional<Point3>>& handles,
                  StepRecord& record) {
  record.energy.elastic += spring_energy(model, state, handles);
  record_nodes(model, state, record);
  record_rigid(model, state, record);
  for (std::size_t n = 0; n < model.node_mass.size(); ++n) {
    record.energy.gravity -= model.node_mass[n] * dot(gravity, state.position[n]);
  }
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    record.energy.gravity -=
        at(model.rigid.mass, r) * dot(gravity, at(state.position, model.node_count + r));
  }
}

}  // namespace tetwarp
