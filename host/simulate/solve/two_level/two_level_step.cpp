/// @file two_level_step.cpp
/// A step of TwoLevelSolver without its contacts: M^-1 (b + J^T r - A v).
#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/simulate/solve/two_level/two_level_solver.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {
/// y = x + M^-1 d, d = force - A x. @returns d . M^-1 d
double TwoLevelSolver::step(const StepSystem& system) {
  GradientArrays<double> a;
  a.rows = system.rows;
  a.values = a.copy = system.values;
  a.p = {x_.data(), static_cast<std::int64_t>(x_.size())};
  a.q = {product_.data(), static_cast<std::int64_t>(product_.size())};
  parallel_tasks(threads_, static_cast<std::int64_t>(chunks_.size()), [&](std::int64_t c) {
    vector_stages().product(a, chunks_[index_of(c)].row_begin, chunks_[index_of(c)].row_end);
    step_chunk(c);
  });
  double square = step_elastic();
  for (const double own : squares_) square += own;
  return square;
}

/// y of elastic bodies. @returns d . M^-1 d of these
double TwoLevelSolver::step_elastic() {
  elastic_squares_.resize(elastic_.bodies().size());
  parallel_tasks(threads_, static_cast<std::int64_t>(elastic_squares_.size()), [&](std::int64_t b) {
    const ElasticBody& own = elastic_.bodies()[index_of(b)];
    const std::size_t begin = 3 * index_of(own.row_begin), end = 3 * index_of(own.row_end);
    elastic_.solve(index_of(b), product_.data() + begin, moved_.data() + begin);
    double square = 0;
    for (std::size_t i = begin; i < end; ++i) {
      y_[i] = x_[i] + moved_[i];
      square += product_[i] * moved_[i];
    }
    elastic_squares_[index_of(b)] = square;
    elastic_.gather(index_of(b), y_.data(), y_.data());
  });
  double square = 0;
  for (const double own : elastic_squares_) square += own;
  return square;
}

/// Adds what the sweeps changed to the rows of elastic bodies.
void TwoLevelSolver::add_elastic() {
  if (elastic_.bodies().empty()) return;
  std::fill(pull_.begin(), pull_.end(), 0.0);
  blocks_.set_changes(stepped_.data(), impulse_.data(), pull_.data());
  parallel_tasks(
      threads_, static_cast<std::int64_t>(elastic_.bodies().size()), [&](std::int64_t b) {
        const ElasticBody& own = elastic_.bodies()[index_of(b)];
        const std::size_t begin = 3 * index_of(own.row_begin), end = 3 * index_of(own.row_end);
        elastic_.solve(index_of(b), pull_.data() + begin, moved_.data() + begin);
        for (std::size_t i = begin; i < end; ++i) y_[i] += moved_[i];
      });
}

/// The rows of a chunk: y, and its part of d . omega D^-1 d.
void TwoLevelSolver::step_chunk(std::int64_t c) {
  const Chunk& chunk = chunks_[index_of(c)];
  const SolvedIsland& island = islands_.list()[index_of(chunk.island)];
  const double omega = island.is_coupled ? relaxation_ : 1;
  double* const d = product_.data();
  const std::int64_t end = 3 * std::int64_t{chunk.row_end};
  for (std::int64_t i = 3 * std::int64_t{chunk.row_begin}; i < end; ++i)
    d[i] = force_[index_of(i)] - d[i];
  double square = 0;
  squares_[index_of(c)] = 0;
  if (island.elastic >= 0) return;
  for (std::int64_t row = chunk.row_begin; row < chunk.row_end; ++row) {
    double z[6];
    const int count = diagonal_.multiply(row, d + 3 * row, z);
    for (int i = 0; i < count; ++i) {
      y_[index_of(3 * row + i)] = x_[index_of(3 * row + i)] + omega * z[i];
      square += omega * d[3 * row + i] * z[i];
    }
  }
  squares_[index_of(c)] = square;
}

}  // namespace tetwarp
