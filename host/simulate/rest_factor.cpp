#include "host/simulate/rest_factor.hpp"
#include "host/base/index_of.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <map>

#include "kernels/body/tet_force.hpp"

namespace tetwarp {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

constexpr std::int32_t most_nodes = 4096;

/// Entries of A_0 between nodes with unknowns of one body.
class RestMatrix {
 public:
  RestMatrix(const Model& model, std::int32_t body, double time_step)
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

  std::int32_t count() const { return count_; }

  void add_tet(std::int32_t t, double time_step) {
    const ModelTets& tets = model_.tets;
    const double scale =
        time_step * (time_step + tets.gamma[index_of(t)]) * tets.volume[index_of(t)];
    const double lambda = scale * tets.lambda[index_of(t)], mu = scale * tets.mu[index_of(t)];
    double g[4][3] = {};
    for (int k = 0; k < 9; ++k) {
      g[1 + k / 3][k % 3] = tets.gradient[index_of(t)][index_of(k)];
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
        add(tets.nodes[index_of(t)][index_of(a)], tets.nodes[index_of(t)][index_of(b)], block);
      }
    }
  }

  /// The matrix with its nodes in the order of least fill.
  /// @param place  out, [nodes] place of each
  Matrix ordered(std::vector<std::int32_t>& place) const {
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

 private:
  std::int32_t slot_of(std::int32_t node) const {
    return node >= begin_ && node < end_ ? slot_[index_of(node - begin_)] : -1;
  }
  void add(std::int32_t a, std::int32_t b, const double* block) {
    const std::int32_t row = slot_of(a), column = slot_of(b);
    if (row < 0 || column < 0) return;
    std::array<double, 9>& own = blocks_[{row, column}];
    for (std::size_t e = 0; e < 9; ++e) own[e] += block[e];
  }
  void add_scalar(std::int32_t a, std::int32_t b, double value) {
    const double block[9] = {value, 0, 0, 0, value, 0, 0, 0, value};
    add(a, b, block);
  }
  void add_masses(double time_step) {
    const ModelScalarBlocks& scalars = model_.scalar_blocks;
    for (std::size_t k = 0; k < scalars.nodes.size(); ++k) {
      add_scalar(scalars.nodes[k][0], scalars.nodes[k][1],
                 scalars.mass[k] + time_step * scalars.mass_alpha[k]);
    }
  }
  void add_springs(double time_step) {
    const ModelSprings& springs = model_.springs;
    for (std::size_t s = 0; s < springs.a.size(); ++s) {
      const double factor = time_step * (time_step * springs.stiffness[s] + springs.damping[s]);
      const auto each = [&](const auto& use) {
        for (std::size_t k = 0; k < 4; ++k) use(springs.a[s].node[k], springs.a[s].weight[k]);
        if (springs.handle[s] >= 0) return;
        for (std::size_t k = 0; k < 4; ++k) use(springs.b[s].node[k], -springs.b[s].weight[k]);
      };
      each([&](std::int32_t a, double weight_a) {
        if (slot_of(a) < 0) return;
        each([&](std::int32_t b, double weight_b) {
          add_scalar(a, b, factor * weight_a * weight_b);
        });
      });
    }
  }

  const Model& model_;
  std::int32_t begin_, end_, count_ = 0;
  std::vector<std::int32_t> slot_;
  std::map<std::array<std::int32_t, 2>, std::array<double, 9>> blocks_;
};

typedef double Four __attribute__((vector_size(4 * sizeof(double))));

bool is_zero(double x) {
  return x == 0;
}
bool is_zero(const Four& x) {
  return x[0] == 0 && x[1] == 0 && x[2] == 0;
}

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

RestFactor::RestFactor(const Model& model, std::int32_t body, double time_step) : model_(model) {
  const std::int32_t begin = model.body_node[index_of(body)],
                     end = model.body_node[index_of(body) + 1];
  RestMatrix rest(model, body, time_step);
  for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
    const std::int32_t node = model.tets.nodes[t][0];
    if (node < begin || node >= end) continue;
    tets_.push_back(static_cast<std::int32_t>(t));
    rest.add_tet(tets_.back(), time_step);
  }
  const Matrix matrix = rest.ordered(order_);
  Eigen::SimplicialLLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> factor(matrix);
  const Matrix lower = factor.matrixL();
  const std::int32_t count = rest.count();
  std::vector<std::int32_t> slot(index_of(count), -1);  // of a row in the column of blocks
  start_.assign(1, 0);
  for (std::int32_t j = 0; j < count; ++j) {
    const std::size_t first = entries_.size();
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
          slot[index_of(row)] = static_cast<std::int32_t>(entries_.size());
          entries_.push_back({row, {}});
        }
        entries_[index_of(slot[index_of(row)])].block[e] = static_cast<float>(it.value());
      }
    }
    for (std::size_t k = first; k < entries_.size(); ++k) slot[index_of(entries_[k].row)] = -1;
    const double a = 1 / corner[0], b = 1 / corner[4], c = 1 / corner[8];
    const double ba = -b * corner[3] * a;
    diagonal_.push_back({static_cast<float>(a), static_cast<float>(ba), static_cast<float>(b),
                         static_cast<float>(-c * (corner[6] * a + corner[7] * ba)),
                         static_cast<float>(-c * corner[7] * b), static_cast<float>(c)});
    start_.push_back(static_cast<std::int32_t>(entries_.size()));
  }
  column_of_.assign(index_of(count), -1);
  work_.resize(index_of(3 * std::int64_t{count}));
}

/// w = A_0^-1 w in the order of L. @tparam Real  a number, or a vector of numbers of as many w
template <class Real>
void RestFactor::substitute(Real* w) const {
  const std::size_t count = order_.size();
  for (std::size_t j = 0; j < count; ++j) {
    Real* const own = w + 3 * j;
    if (is_zero(own[0]) && is_zero(own[1]) && is_zero(own[2])) continue;
    const auto& l = diagonal_[j];
    const Real a = double{l[0]} * own[0], b = double{l[1]} * own[0] + double{l[2]} * own[1];
    const Real c = double{l[3]} * own[0] + double{l[4]} * own[1] + double{l[5]} * own[2];
    own[0] = a, own[1] = b, own[2] = c;
    for (std::int32_t k = start_[j]; k < start_[j + 1]; ++k) {
      const Entry& entry = entries_[index_of(k)];
      const float* const e = entry.block;
      Real* const out = w + 3 * index_of(entry.row);
      for (int i = 0; i < 3; ++i) {
        out[i] -= double{e[3 * i]} * a + double{e[3 * i + 1]} * b + double{e[3 * i + 2]} * c;
      }
    }
  }
  for (std::size_t j = count; j-- > 0;) {
    Real* const own = w + 3 * j;
    Real a = own[0], b = own[1], c = own[2];
    for (std::int32_t k = start_[j]; k < start_[j + 1]; ++k) {
      const Entry& entry = entries_[index_of(k)];
      const float* const e = entry.block;
      const Real* const in = w + 3 * index_of(entry.row);
      a -= double{e[0]} * in[0] + double{e[3]} * in[1] + double{e[6]} * in[2];
      b -= double{e[1]} * in[0] + double{e[4]} * in[1] + double{e[7]} * in[2];
      c -= double{e[2]} * in[0] + double{e[5]} * in[1] + double{e[8]} * in[2];
    }
    const auto& l = diagonal_[j];
    own[0] = double{l[0]} * a + double{l[1]} * b + double{l[3]} * c;
    own[1] = double{l[2]} * b + double{l[4]} * c;
    own[2] = double{l[5]} * c;
  }
}

void RestFactor::solve_turned(const std::array<double, 9>& rotation,
                              const double* push,
                              double* out) {
  const auto& r = rotation;
  for (const std::int32_t place : order_) {
    double* const w = work_.data() + 3 * index_of(place);
    for (std::size_t i = 0; i < 3; ++i) {
      w[i] = r[i] * push[0] + r[3 + i] * push[1] + r[6 + i] * push[2];
    }
    push += 3;
  }
  substitute(work_.data());
  for (const std::int32_t place : order_) {
    const double* const w = work_.data() + 3 * index_of(place);
    for (std::size_t i = 0; i < 3; ++i) {
      out[i] = r[3 * i] * w[0] + r[3 * i + 1] * w[1] + r[3 * i + 2] * w[2];
    }
    out += 3;
  }
}

const float* RestFactor::columns(std::int32_t node) {
  const std::size_t size = 3 * order_.size();
  std::int32_t& place = column_of_[index_of(node)];
  if (place < 0) {
    place = static_cast<std::int32_t>(columns_.size() / (3 * size));
    columns_.resize(columns_.size() + 3 * size);
    std::vector<Four> w(size, Four{});  // the three columns side by side
    for (std::size_t i = 0; i < 3; ++i) w[3 * index_of(order_[index_of(node)]) + i][i] = 1;
    substitute(w.data());
    float* const out = columns_.data() + 3 * size * index_of(place);
    for (std::size_t k = 0; k < size; ++k) {
      const Four& own = w[3 * index_of(order_[k / 3]) + k % 3];
      for (std::size_t i = 0; i < 3; ++i) out[i * size + k] = static_cast<float>(own[i]);
    }
  }
  return columns_.data() + 3 * size * index_of(place);
}

std::array<double, 9> RestFactor::mean_rotation(const double* position) const {
  double sum[9] = {};
  for (const std::int32_t t : tets_) {
    double x[12], f[9];
    for (std::size_t a = 0; a < 4; ++a) {
      const std::int32_t node = model_.tets.nodes[index_of(t)][a];
      std::copy_n(position + 3 * std::int64_t{node}, 3, x + 3 * a);
    }
    deformation_gradient(x, model_.tets.gradient[index_of(t)].data(), f);
    for (int e = 0; e < 9; ++e) sum[e] += model_.tets.volume[index_of(t)] * f[e];
  }
  std::array<double, 9> rotation;
  tet_rotation(sum, rotation.data());
  return rotation;
}

}  // namespace tetwarp
