#include "tests/simulate/body_models.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>

namespace tetwarp::test {
namespace {
using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

Vector vector(const Point3& p) {
  return {p[0], p[1], p[2]};
}

void append_tet(Model& model, std::array<std::int32_t, 4> nodes, const BlockOptions& options) {
  const auto x = [&](std::size_t a) {
    return vector(model.start.position[static_cast<std::size_t>(nodes[a])]);
  };
  Matrix edges;
  edges << x(1) - x(0), x(2) - x(0), x(3) - x(0);
  if (edges.determinant() < 0) {
    std::swap(nodes[2], nodes[3]);
    edges << x(1) - x(0), x(2) - x(0), x(3) - x(0);
  }
  const Matrix inverse = edges.inverse();
  std::array<double, 9> gradient;
  for (int k = 0; k < 9; ++k) gradient[static_cast<std::size_t>(k)] = inverse(k / 3, k % 3);
  model.tets.nodes.push_back(nodes);
  model.tets.gradient.push_back(gradient);
  model.tets.volume.push_back(edges.determinant() / 6);
  const double nu = options.poisson;
  model.tets.lambda.push_back(options.youngs * nu / ((1 + nu) * (1 - 2 * nu)));
  model.tets.mu.push_back(options.youngs / (2 * (1 + nu)));
  model.tets.gamma.push_back(options.gamma);
}

/// Appends nodes for a body of its own. Blocks of rigid bodies come after all nodes.
std::int32_t begin_body(Model& model, std::int32_t nodes) {
  if (model.rigid_count > 0) throw std::logic_error("nodes are added before rigid bodies");
  const std::int32_t first = model.node_count;
  model.node_count += nodes;
  model.body_node.push_back(model.node_count);
  model.body_rigid.push_back(-1);
  model.body_island.push_back(model.island_count++);
  const auto blocks = static_cast<std::size_t>(model.node_count);
  model.prescribed.resize(blocks, 0);
  model.node_mass.resize(blocks, 0);
  model.start.velocity.resize(blocks);
  return first;
}

void add_masses(Model& model, const std::map<std::array<std::int32_t, 2>, double>& masses) {
  ModelScalarBlocks& scalars = model.scalar_blocks;
  for (const auto& [nodes, mass] : masses) {
    scalars.nodes.push_back(nodes);
    scalars.mass.push_back(mass);
    scalars.mass_alpha.push_back(0);
    scalars.bend.push_back(0);
    scalars.bend_gamma.push_back(0);
    model.node_mass[static_cast<std::size_t>(nodes[0])] += mass;
  }
}
}  // namespace

Model empty_model() {
  Model model;
  model.body_node = {0};
  return model;
}

std::int32_t add_block(Model& model, const BlockOptions& options) {
  const auto& cells = options.cells;
  const int nx = cells[0] + 1, ny = cells[1] + 1, nz = cells[2] + 1;
  const std::int32_t first = begin_body(model, nx * ny * nz);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-options.jitter, options.jitter);
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const bool is_inner =
            i > 0 && j > 0 && k > 0 && i < cells[0] && j < cells[1] && k < cells[2];
        const int ijk[3] = {i, j, k};
        Point3 p;
        for (std::size_t d = 0; d < 3; ++d) {
          p[d] = options.origin[d] + options.edge * (ijk[d] + (is_inner ? shift(random) : 0));
        }
        model.start.position.push_back(p);
      }
    }
  }
  const auto node = [&](int i, int j, int k) { return first + (k * ny + j) * nx + i; };
  const std::size_t first_tet = model.tets.nodes.size();
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        std::int32_t c[8];
        for (int v = 0; v < 8; ++v) c[v] = node(i + (v & 1), j + (v >> 1 & 1), k + (v >> 2));
        const bool is_odd = (i + j + k) % 2 != 0;
        const int even_tets[5][4] = {
            {0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}};
        for (const auto& tet : even_tets) {
          std::array<std::int32_t, 4> nodes;
          for (std::size_t a = 0; a < 4; ++a) nodes[a] = c[is_odd ? tet[a] ^ 1 : tet[a]];
          append_tet(model, nodes, options);
        }
      }
    }
  }
  std::map<std::array<std::int32_t, 2>, double> masses;
  for (std::size_t t = first_tet; t < model.tets.nodes.size(); ++t) {
    for (const std::int32_t a : model.tets.nodes[t]) {
      for (const std::int32_t b : model.tets.nodes[t]) {
        masses[{a, b}] += options.density * model.tets.volume[t] * (a == b ? 0.1 : 0.05);
      }
    }
  }
  add_masses(model, masses);
  return first;
}

std::int32_t add_sheet(Model& model, int cells, double edge, double stiffness, double mass) {
  const int n = cells + 1;
  const std::int32_t first = begin_body(model, n * n);
  std::map<std::array<std::int32_t, 2>, double> masses;
  const auto join = [&](std::int32_t a, std::int32_t b, double length) {
    model.edges.nodes.push_back({a, b});
    model.edges.stiffness.push_back(stiffness);
    model.edges.rest_length.push_back(length);
    model.edges.gamma.push_back(0);
  };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const std::int32_t node = first + j * n + i;
      model.start.position.push_back({edge * i, edge * j, 0});
      masses[{node, node}] = mass / (n * n);
      if (i < cells) join(node, node + 1, edge);
      if (j < cells) join(node, node + n, edge);
      if (i < cells && j < cells) join(node, node + n + 1, edge * std::sqrt(2.0));
    }
  }
  add_masses(model, masses);
  return first;
}

std::int32_t add_rigid(Model& model, double mass, const Point3& moments, const Point3& center) {
  model.body_node.push_back(model.node_count);
  model.body_rigid.push_back(model.rigid_count);
  model.body_island.push_back(model.island_count++);
  model.rigid.body.push_back(static_cast<std::int32_t>(model.body_rigid.size()) - 1);
  model.rigid.mass.push_back(mass);
  model.rigid.inertia.push_back(moments);
  model.rigid.alpha.push_back(0);
  model.start.position.push_back(center);
  model.start.rotation.push_back({1, 0, 0, 0});
  model.start.angular_momentum.push_back({0, 0, 0});
  ++model.rigid_count;
  const auto blocks = static_cast<std::size_t>(model.block_count());
  model.prescribed.resize(blocks, 0);
  model.start.velocity.resize(blocks);
  return model.rigid_count - 1;
}

void add_spring(
    Model& model, const ModelPoint& a, const ModelPoint& b, double stiffness, double damping) {
  model.springs.a.push_back(a);
  model.springs.b.push_back(b);
  model.springs.stiffness.push_back(stiffness);
  model.springs.damping.push_back(damping);
  model.springs.coupling.push_back(-1);
  model.springs.handle.push_back(-1);
  if (a.body < 0 || b.body < 0) return;
  auto& island = model.body_island;
  const std::int32_t one = island[static_cast<std::size_t>(a.body)];
  const std::int32_t other = island[static_cast<std::size_t>(b.body)];
  if (one == other) return;
  const std::int32_t low = std::min(one, other), high = std::max(one, other);
  for (std::int32_t& i : island) i = i == high ? low : i > high ? i - 1 : i;
  --model.island_count;
}

ModelPoint node_point(const Model& model, std::int32_t node) {
  ModelPoint point;
  const auto past = std::upper_bound(model.body_node.begin(), model.body_node.end(), node);
  point.body = static_cast<std::int32_t>(past - model.body_node.begin()) - 1;
  point.node[0] = node;
  point.weight[0] = 1;
  return point;
}
ModelPoint rigid_point(const Model& model, std::int32_t rigid, const Point3& local) {
  ModelPoint point;
  point.body = model.rigid.body[static_cast<std::size_t>(rigid)];
  point.rigid = rigid;
  point.local = local;
  return point;
}
ModelPoint world_point(const Point3& position) {
  ModelPoint point;
  point.local = position;
  return point;
}

StepInput input_for(const Model& model, double time_step, const Point3& gravity) {
  StepInput input;
  input.time_step = time_step;
  input.gravity = gravity;
  const auto blocks = static_cast<std::size_t>(model.block_count());
  input.prescribed_velocity.resize(blocks);
  input.block_force.resize(blocks);
  input.anchor.resize(model.springs.a.size());
  input.anchor_velocity.resize(model.springs.a.size());
  input.is_active.assign(model.springs.a.size(), 1);
  return input;
}

}  // namespace tetwarp::test
