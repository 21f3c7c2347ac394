/// @file rest_factor.cpp
/// Factorization, solves in the turned frame, and columns of the inverse.
#include "host/simulate/step/cpu/rest_factor.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/base/vector_view.hpp"
#include "host/simulate/step/cpu/rest_matrix.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {
namespace {

using Matrix = RestMatrix::Matrix;

constexpr std::int32_t most_nodes = 4096;  // all columns() then take 36 * 4096^2 bytes, 604 MB

}  // namespace

bool RestFactor::is_possible(const Model& model, std::int32_t body) {
  const std::int32_t begin = model.body_node[index_of(body)],
                     end = model.body_node[index_of(body) + 1];
  if (model.body_rigid[index_of(body)] >= 0 || end - begin > most_nodes) return false;
  const auto is_own = [&](std::int32_t node) { return node >= begin && node < end; };
  for (const auto& nodes : model.edges.nodes) {
    if (is_own(nodes[0])) return false;
  }
  for (const auto& nodes : model.tets.nodes) {
    if (is_own(nodes[0])) return true;
  }
  return false;
}

RestFactor::RestFactor(const Model& model, std::int32_t body, double time_step) {
  const std::int32_t begin = model.body_node[index_of(body)],
                     end = model.body_node[index_of(body) + 1];
  RestMatrix rest(model, body, time_step);
  std::vector<std::size_t> tets;
  for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
    const std::int32_t node = model.tets.nodes[t][0];
    if (node < begin || node >= end) continue;
    tets.push_back(t);
    rest.add_tet(t, time_step);
  }
  set_gradients(model, body, tets);
  const Matrix matrix = rest.ordered(order_);
  Eigen::SimplicialLLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> factor(matrix);
  const Matrix lower = factor.matrixL();
  const std::int32_t count = rest.count();
  std::vector<std::int32_t> slot(index_of(count), -1);  // of a row in the column of blocks
  start_.assign(1, 0);
  for (std::int32_t j = 0; j < count; ++j) {
    const std::size_t first = row_.size();
    double corner[9] = {};
    for (int c = 0; c < 3; ++c) {
      for (Matrix::InnerIterator it(lower, 3 * j + c); it; ++it) {
        const auto row = static_cast<std::int32_t>(it.row() / 3);
        const auto e = static_cast<std::size_t>(3 * (it.row() % 3) + c);
        if (row == j) {
          corner[e] = it.value();
          continue;
        }
        if (slot[index_of(row)] < 0) {
          slot[index_of(row)] = static_cast<std::int32_t>(row_.size());
          row_.push_back(row);
          block_.resize(block_.size() + 9);
        }
        block_[9 * index_of(slot[index_of(row)]) + 3 * (e % 3) + e / 3] =
            static_cast<float>(it.value());
      }
    }
    for (std::size_t k = first; k < row_.size(); ++k) slot[index_of(row_[k])] = -1;
    const double a = 1 / corner[0], b = 1 / corner[4], c = 1 / corner[8];
    const double ba = -b * corner[3] * a;
    for (const double value :
         {a, ba, b, -c * (corner[6] * a + corner[7] * ba), -c * corner[7] * b, c}) {
      diagonal_.push_back(static_cast<float>(value));
    }
    start_.push_back(static_cast<std::int32_t>(row_.size()));
  }
  block_.push_back(0);
  column_of_.assign(index_of(count), -1);
  work_.resize(index_of(4 * std::int64_t{count}));
}

void RestFactor::substitute() {
  vector_stages().substitute({view_of(start_), view_of(row_), view_of(block_), view_of(diagonal_)},
                             work_.data());
}

void RestFactor::solve_turned(const std::array<double, 9>& rotation,
                              const double* push,
                              double* out) {
  const auto& r = rotation;
  for (const std::int32_t place : order_) {
    double* const w = work_.data() + 4 * index_of(place);
    for (std::size_t i = 0; i < 3; ++i) {
      w[i] = r[i] * push[0] + r[3 + i] * push[1] + r[6 + i] * push[2];
    }
    w[3] = 0;
    push += 3;
  }
  substitute();
  for (const std::int32_t place : order_) {
    const double* const w = work_.data() + 4 * index_of(place);
    for (std::size_t i = 0; i < 3; ++i) {
      out[i] = r[3 * i] * w[0] + r[3 * i + 1] * w[1] + r[3 * i + 2] * w[2];
    }
    out += 3;
  }
}

/// @param out  [3][nodes][3]
void RestFactor::find_columns(std::int32_t node, float* out) {
  for (std::size_t i = 0; i < 3; ++i) {
    std::ranges::fill(work_, 0.0);
    work_[4 * index_of(order_[index_of(node)]) + i] = 1;
    substitute();
    for (const std::int32_t own : order_) {
      const double* const w = work_.data() + 4 * index_of(own);
      for (std::size_t k = 0; k < 3; ++k) *out++ = static_cast<float>(w[k]);
    }
  }
}

const float* RestFactor::columns(std::int32_t node) {
  const std::size_t size = 3 * order_.size();
  std::int32_t& place = column_of_[index_of(node)];
  if (place < 0) {
    place = static_cast<std::int32_t>(columns_.size() / (3 * size));
    columns_.resize(columns_.size() + 3 * size);
    find_columns(node, columns_.data() + 3 * size * index_of(place));
  }
  return columns_.data() + 3 * size * index_of(place);
}

void RestFactor::inverse(std::vector<float>& out) {
  const std::size_t size = 3 * order_.size();
  out.resize(size * size);
  for (std::int32_t node = 0; node < node_count(); ++node) {
    find_columns(node, out.data() + 3 * size * index_of(node));
  }
}

/// Gradients of a node within the body add up to zero: such nodes are left out.
void RestFactor::set_gradients(const Model& model,
                               std::int32_t body,
                               const std::vector<std::size_t>& tets) {
  const std::int32_t begin = model.body_node[index_of(body)],
                     end = model.body_node[index_of(body) + 1];
  std::vector<Point3> sum(index_of(end - begin), Point3{0, 0, 0});
  double largest = 0;
  for (const std::size_t t : tets) {
    const auto& nodes = model.tets.nodes[t];
    for (std::size_t a = 1; a < 4; ++a) {
      const double* const g = model.tets.gradient[t].data() + 3 * (a - 1);
      const Point3 own = times(model.tets.volume[t], Point3{g[0], g[1], g[2]});
      Point3 &at_corner = sum[index_of(nodes[a] - begin)],
             &at_first = sum[index_of(nodes[0] - begin)];
      at_corner = plus(at_corner, own);
      at_first = minus(at_first, own);
      largest = std::max(largest, norm(own));
    }
  }
  for (std::int32_t node = begin; node < end; ++node) {
    const Point3& own = sum[index_of(node - begin)];
    if (norm(own) > 1e-12 * largest) gradients_.push_back({node, own});
  }
}

std::array<double, 9> RestFactor::mean_rotation(const double* position) const {
  double sum[9] = {};
  const double* const origin = position + 3 * std::int64_t{gradients_.front().node};
  for (const NodeGradient& own : gradients_) {
    const double* const x = position + 3 * std::int64_t{own.node};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) sum[3 * i + j] += (x[i] - origin[i]) * own.sum[j];
    }
  }
  std::array<double, 9> rotation;
  tet_rotation(sum, rotation.data());
  return rotation;
}

}  // namespace tetwarp
