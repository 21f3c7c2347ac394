/// @file rest_matrix.cpp
/// Sums of elements, masses and springs, in an order that keeps factors sparse.
#include "host/simulate/step/cpu/rest_matrix.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>

#include "host/base/index_of.hpp"

namespace tetwarp {

RestMatrix::RestMatrix(const Model& model, std::int32_t body, double time_step)
    : model_(model),
      begin_(model.body_node[index_of(body)]),
      end_(model.body_node[index_of(body) + 1]) {
  slot_.assign(index_of(end_ - begin_), -1);
  for (std::int32_t n = begin_; n < end_; ++n) {
    if (model.prescribed[index_of(n)] == 0) slot_[index_of(n - begin_)] = count_++;
  }
  add_masses(time_step);
  add_springs(time_step);
}

void RestMatrix::add_tet(std::size_t t, double time_step) {
  const ModelTets& tets = model_.tets;
  const double scale = time_step * (time_step + tets.gamma[t]) * tets.volume[t];
  const double lambda = scale * tets.lambda[t], mu = scale * tets.mu[t];
  double g[4][3] = {};
  for (int k = 0; k < 9; ++k) {
    g[1 + k / 3][k % 3] = tets.gradient[t][index_of(k)];
    g[0][k % 3] -= g[1 + k / 3][k % 3];
  }
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      const double along = g[a][0] * g[b][0] + g[a][1] * g[b][1] + g[a][2] * g[b][2];
      double block[9];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          block[3 * i + j] =
              lambda * g[a][i] * g[b][j] + mu * g[b][i] * g[a][j] + (i == j ? mu * along : 0);
        }
      }
      add(tets.nodes[t][index_of(a)], tets.nodes[t][index_of(b)], block);
    }
  }
}

RestMatrix::Matrix RestMatrix::ordered(std::vector<std::int32_t>& place) const {
  std::vector<Eigen::Triplet<double>> graph;
  for (const auto& [nodes, block] : blocks_) graph.emplace_back(nodes[0], nodes[1], block[0]);
  Matrix pattern(count_, count_);
  pattern.setFromTriplets(graph.begin(), graph.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  place.resize(index_of(count_));
  for (std::int32_t k = 0; k < count_; ++k) place[index_of(order.indices()[k])] = k;
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [nodes, block] : blocks_) {
    const int row = 3 * place[index_of(nodes[0])], column = 3 * place[index_of(nodes[1])];
    if (row < column) continue;
    for (int e = 0; e < 9; ++e) {
      entries.emplace_back(row + e / 3, column + e % 3, block[index_of(e)]);
    }
  }
  Matrix result(3 * count_, 3 * count_);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

std::int32_t RestMatrix::slot_of(std::int32_t node) const {
  return node >= begin_ && node < end_ ? slot_[index_of(node - begin_)] : -1;
}

void RestMatrix::add(std::int32_t a, std::int32_t b, const double* block) {
  const std::int32_t row = slot_of(a), column = slot_of(b);
  if (row < 0 || column < 0) return;
  std::array<double, 9>& own = blocks_[{row, column}];
  for (std::size_t e = 0; e < 9; ++e) own[e] += block[e];
}

void RestMatrix::add_scalar(std::int32_t a, std::int32_t b, double value) {
  const double block[9] = {value, 0, 0, 0, value, 0, 0, 0, value};
  add(a, b, block);
}

void RestMatrix::add_masses(double time_step) {
  const ModelScalarBlocks& scalars = model_.scalar_blocks;
  for (std::size_t k = 0; k < scalars.nodes.size(); ++k) {
    add_scalar(scalars.nodes[k][0], scalars.nodes[k][1],
               scalars.mass[k] + time_step * scalars.mass_alpha[k]);
  }
}

/// Whether a point moves with unknowns of another body.
bool RestMatrix::is_elsewhere(const ModelPoint& point) const {
  const auto has_unknowns = [&](std::int64_t block) {
    return model_.prescribed[index_of(block)] == 0;
  };
  if (point.rigid >= 0) return has_unknowns(model_.node_count + 2 * std::int64_t{point.rigid});
  return std::ranges::any_of(point.node, [&](std::int32_t node) {
    return node >= 0 && (node < begin_ || node >= end_) && has_unknowns(node);
  });
}

/// Of a spring between two bodies the entries between them are left out. With its own ones twice,
/// v^T A v of all bodies together is at most that of the matrices at rest.
void RestMatrix::add_springs(double time_step) {
  const ModelSprings& springs = model_.springs;
  for (std::size_t s = 0; s < springs.a.size(); ++s) {
    const bool is_between =
        springs.handle[s] < 0 && (is_elsewhere(springs.a[s]) || is_elsewhere(springs.b[s]));
    const double factor =
        (is_between ? 2 : 1) * time_step * (time_step * springs.stiffness[s] + springs.damping[s]);
    const auto each = [&](const auto& use) {
      for (std::size_t k = 0; k < 4; ++k) use(springs.a[s].node[k], springs.a[s].weight[k]);
      if (springs.handle[s] >= 0) return;
      for (std::size_t k = 0; k < 4; ++k) use(springs.b[s].node[k], -springs.b[s].weight[k]);
    };
    each([&](std::int32_t a, double weight_a) {
      if (slot_of(a) < 0) return;
      each(
          [&](std::int32_t b, double weight_b) { add_scalar(a, b, factor * weight_a * weight_b); });
    });
  }
}

}  // namespace tetwarp
