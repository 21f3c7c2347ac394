#include "host/simulate/contact/coarse_space.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "kernels/contact/contact_setup.hpp"

namespace tetwarp {
namespace {

/// Polynomials 1, x, y, z that are orthonormal over points; one that vanishes on them is zero.
struct AffineBasis {
  double count = 0;
  Point3 mean{0, 0, 0};
  std::array<double, 9> products{};  ///< sums of products of x - mean, lower triangle; then rows of
                                     ///< the inverse of its Cholesky factor
  bool is_ready = false;

  void add_point(const Point3& x) {
    count += 1;
    for (std::size_t i = 0; i < 3; ++i) mean[i] += x[i];
  }
  void add_products(const Point3& x) {
    const Point3 d = minus(x, times(1 / count, mean));
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j <= i; ++j) products[3 * i + j] += d[i] * d[j];
    }
  }
  void finish() {
    mean = times(1 / count, mean);
    constexpr double vanishing = 1e-9;  // of the largest square
    const double least = vanishing * std::max({products[0], products[4], products[8]});
    std::array<double, 9> factor = products, inverse{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        double sum = factor[3 * i + j];
        for (std::size_t k = 0; k < j; ++k) sum -= factor[3 * i + k] * factor[3 * j + k];
        factor[3 * i + j] = factor[4 * j] > 0 ? sum / factor[4 * j] : 0;
      }
      double pivot = factor[4 * i];
      for (std::size_t k = 0; k < i; ++k) pivot -= factor[3 * i + k] * factor[3 * i + k];
      factor[4 * i] = pivot > least ? std::sqrt(pivot) : 0;
      if (factor[4 * i] == 0) continue;
      inverse[4 * i] = 1 / factor[4 * i];
      for (std::size_t j = 0; j < i; ++j) {
        double sum = 0;
        for (std::size_t k = j; k < i; ++k) sum += factor[3 * i + k] * inverse[3 * k + j];
        inverse[3 * i + j] = -sum / factor[4 * i];
      }
    }
    products = inverse;
  }
  void values_at(const Point3& x, double* value) const {
    const Point3 d = minus(x, mean);
    value[0] = 1 / std::sqrt(count);
    for (std::size_t i = 0; i < 3; ++i) {
      value[1 + i] = 0;
      for (std::size_t j = 0; j <= i; ++j) value[1 + i] += products[3 * i + j] * d[j];
    }
  }
};

}  // namespace

CoarseSpace::CoarseSpace(const Model& model)
    : model_(model),
      body_of_(index_of(model.block_count())),
      slot_of_(model.body_rigid.size(), -1) {
  for (std::size_t body = 0; body < model.body_rigid.size(); ++body) {
    const auto own = static_cast<std::int32_t>(body);
    for (std::int32_t n = model.body_node[body]; n < model.body_node[body + 1]; ++n) {
      body_of_[index_of(n)] = own;
    }
    if (model.body_rigid[body] < 0) continue;
    const std::int64_t linear = model.node_count + 2 * std::int64_t{model.body_rigid[body]};
    body_of_[index_of(linear)] = body_of_[index_of(linear + 1)] = own;
  }
}

void CoarseSpace::set(const StepSystem& system,
                      const ModelState& state,
                      const ContactIslands& islands,
                      const std::vector<std::uint8_t>& takes,
                      const ElasticSpace& elastic,
                      int threads) {
  list_islands(system.rows, islands, takes, elastic);
  rows_.resize(index_of(system.rows.unknown_count));
  mode_count_ = 0;
  std::int64_t numbers = 0;
  for (CoarseIsland& island : islands_) {
    set_rows(system.rows, state, island);
    island.mode_begin = mode_count_;
    island.inverse_begin = numbers;
    mode_count_ += island.mode_count;
    numbers += std::int64_t{island.mode_count} * island.mode_count;
  }
  inverse_.assign(index_of(numbers), 0);
  parallel_tasks(threads, static_cast<std::int64_t>(islands_.size()),
                 [&](std::int64_t i) { set_inverse(system, islands_[index_of(i)]); });
}

void CoarseSpace::list_islands(const SystemRows& rows,
                               const ContactIslands& islands,
                               const std::vector<std::uint8_t>& takes,
                               const ElasticSpace& elastic) {
  islands_.clear();
  island_of_row_.assign(index_of(rows.unknown_count), -1);
  std::int32_t last = -1;
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    const std::int32_t island = islands.of_block(rows.block_of[row]);
    if (takes[index_of(island)] == 0) continue;
    if (island != last) {
      islands_.emplace_back();
      islands_.back().row_begin = row;
      islands_.back().is_coupled = islands.is_coupled(island);
      islands_.back().elastic = elastic.body_of_row(row);
      last = island;
    }
    islands_.back().row_end = row + 1;
    island_of_row_[index_of(row)] = static_cast<std::int32_t>(islands_.size()) - 1;
  }
}

void CoarseSpace::set_rows(const SystemRows& rows, const ModelState& state, CoarseIsland& island) {
  island.mode_count = 0;
  std::vector<AffineBasis> bases;
  std::vector<std::int32_t> bodies;
  for (std::int32_t row = island.row_begin; row < island.row_end; ++row) rows_[index_of(row)] = {};
  if (!island.is_coupled || island.elastic >= 0) return;
  const auto each = [&](const auto& use) {
    for (std::int32_t row = island.row_begin; row < island.row_end; ++row) {
      const std::int32_t block = rows.block_of[row];
      use(row, block, body_of_[index_of(block)]);
    }
  };
  each([&](std::int32_t, std::int32_t block, std::int32_t body) {
    if (slot_of_[index_of(body)] < 0) {
      slot_of_[index_of(body)] = static_cast<std::int32_t>(bodies.size());
      bodies.push_back(body);
      bases.emplace_back();
    }
    if (block < model_.node_count) {
      bases[index_of(slot_of_[index_of(body)])].add_point(state.position[index_of(block)]);
    }
  });
  each([&](std::int32_t, std::int32_t block, std::int32_t body) {
    if (block >= model_.node_count) return;
    bases[index_of(slot_of_[index_of(body)])].add_products(state.position[index_of(block)]);
  });
  std::vector<std::int32_t> first;
  for (AffineBasis& basis : bases) {
    first.push_back(island.mode_count);
    if (basis.count > 0) basis.finish();
    island.mode_count += basis.count > 0 ? 12 : 6;
  }
  if (island.mode_count > most_modes) island.mode_count = 0;
  each([&](std::int32_t row, std::int32_t block, std::int32_t body) {
    if (island.mode_count == 0) return;
    const std::size_t slot = index_of(slot_of_[index_of(body)]);
    CoarseRow& own = rows_[index_of(row)];
    if (block < model_.node_count) {
      own = {first[slot], 4, {}};
      bases[slot].values_at(state.position[index_of(block)], own.factor);
    } else {
      own = {first[slot] + (rows.pair[row] == 2 ? 3 : 0), 1, {1}};
    }
  });
  for (const std::int32_t body : bodies) slot_of_[index_of(body)] = -1;
}

/// Z^T A Z, a row of A at a time, and its inverse. Modes that vanish get the diagonal 1.
void CoarseSpace::set_inverse(const StepSystem& system, const CoarseIsland& island) {
  const std::int32_t m = island.mode_count;
  if (m == 0) return;
  double* const e = inverse_.data() + island.inverse_begin;
  for (std::int32_t row = island.row_begin; row < island.row_end; ++row) {
    const CoarseRow& own = rows_[index_of(row)];
    const std::int32_t end = system.rows.free_end[row];
    for (std::int32_t k = system.rows.start[row]; k < end;) {
      const CoarseRow& first = rows_[index_of(system.rows.column[k])];
      double sum[4][9] = {};  // of successive blocks whose columns have the same modes
      for (; k < end; ++k) {
        const CoarseRow& other = rows_[index_of(system.rows.column[k])];
        if (other.first != first.first) break;
        const double* const a = system.values.data + 9 * std::int64_t{k};
        for (std::int32_t q = 0; q < first.count; ++q) {
          for (int i = 0; i < 9; ++i) sum[q][i] += other.factor[q] * a[i];
        }
      }
      for (std::int32_t p = 0; p < own.count; ++p) {
        for (std::int32_t q = 0; q < first.count; ++q) {
          for (int i = 0; i < 3; ++i) {
            double* const out = e + std::int64_t{own.first + 3 * p + i} * m + first.first + 3 * q;
            for (int j = 0; j < 3; ++j) out[j] += own.factor[p] * sum[q][3 * j + i];
          }
        }
      }
    }
  }
  for (std::int32_t i = 0; i < m; ++i) {
    if (e[std::int64_t{i} * m + i] == 0) e[std::int64_t{i} * m + i] = 1;
  }
  invert_spd(e, m);
}

}  // namespace tetwarp
