/// @file two_level_step.cpp
/// Products, inverses of diagonal blocks and solves of elastic bodies, in parallel.
#include "host/simulate/solve/two_level/two_level_step.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {
namespace {

constexpr std::int32_t chunk_rows = 64;

}  // namespace

/// Divides the islands; both rows of a rigid body are in one chunk.
void TwoLevelStep::list_chunks(const SystemRows& rows) {
  chunks_.clear();
  for (std::size_t i = 0; i < islands_->list().size(); ++i) {
    const IslandRange& island = islands_->list()[i];
    for (std::int32_t row = island.row_begin; row < island.row_end;) {
      std::int32_t end = std::min(row + chunk_rows, island.row_end);
      if (end < island.row_end && rows.pair[end] == 2) ++end;
      chunks_.push_back({row, end, static_cast<std::int32_t>(i)});
      row = end;
    }
  }
  squares_.resize(chunks_.size());
}

void TwoLevelStep::set(const StepSystem& system,
                       const TakenIslands& islands,
                       ElasticSpace& elastic,
                       std::vector<double>& weights) {
  const SystemRows& all = system.rows;
  islands_ = &islands;
  elastic_ = &elastic;
  list_chunks(all);
  inverse_.resize(
      index_of(9 * std::int64_t{all.unknown_count} + 36 * std::int64_t{model_.rigid_count}));
  diagonal_ = {all.pair,
               all.block_of,
               all.unknown_count,
               model_.node_count,
               {inverse_.data(), static_cast<std::int64_t>(inverse_.size())}};
  for (auto* values : {&product_, &pull_, &moved_}) values->resize(3 * index_of(all.count));
  weights.assign(3 * index_of(all.count), 0.0);
  const RowInvertOp<double> invert{all, system.values, diagonal_};
  parallel_tasks(threads_, static_cast<std::int64_t>(chunks_.size()), [&](std::int64_t c) {
    const Chunk& chunk = chunks_[index_of(c)];
    for (std::int32_t row = chunk.row_begin; row < chunk.row_end; ++row) {
      invert(row);
      const double* const own = system.values.data + 9 * std::int64_t{all.diagonal[row]};
      for (int i = 0; i < 3; ++i) weights[index_of(3 * std::int64_t{row} + i)] = own[4 * i];
    }
  });
}

double TwoLevelStep::run(const StepSystem& system,
                         const std::vector<double>& x,
                         const std::vector<double>& force,
                         std::vector<double>& y) {
  GradientArrays<double> a;
  a.rows = system.rows;
  a.values = a.copy = system.values;
  a.p = {const_cast<double*>(x.data()), static_cast<std::int64_t>(x.size())};  // only read
  a.q = {product_.data(), static_cast<std::int64_t>(product_.size())};
  parallel_tasks(threads_, static_cast<std::int64_t>(chunks_.size()), [&](std::int64_t c) {
    vector_stages().product(a, chunks_[index_of(c)].row_begin, chunks_[index_of(c)].row_end);
    step_chunk(c, x, force, y);
  });
  double square = step_elastic(x, y);
  for (const double own : squares_) square += own;
  return square;
}

/// y of elastic bodies. @returns their part of d . M^-1 d
double TwoLevelStep::step_elastic(const std::vector<double>& x, std::vector<double>& y) {
  elastic_squares_.resize(elastic_->bodies().size());
  parallel_tasks(threads_, static_cast<std::int64_t>(elastic_squares_.size()), [&](std::int64_t b) {
    const ElasticBody& own = elastic_->bodies()[index_of(b)];
    const std::size_t begin = 3 * index_of(own.row_begin), end = 3 * index_of(own.row_end);
    elastic_->solve(index_of(b), product_.data() + begin, moved_.data() + begin);
    double square = 0;
    for (std::size_t i = begin; i < end; ++i) {
      y[i] = x[i] + moved_[i];
      square += product_[i] * moved_[i];
    }
    elastic_squares_[index_of(b)] = square;
    elastic_->gather(index_of(b), y.data(), y.data());
  });
  double square = 0;
  for (const double own : elastic_squares_) square += own;
  return square;
}

void TwoLevelStep::add_elastic(const TouchingBlocks& blocks,
                               const double* before,
                               const double* after,
                               std::vector<double>& y) {
  if (elastic_->bodies().empty()) return;
  std::fill(pull_.begin(), pull_.end(), 0.0);
  blocks.set_changes(before, after, pull_.data());
  parallel_tasks(
      threads_, static_cast<std::int64_t>(elastic_->bodies().size()), [&](std::int64_t b) {
        const ElasticBody& own = elastic_->bodies()[index_of(b)];
        const std::size_t begin = 3 * index_of(own.row_begin), end = 3 * index_of(own.row_end);
        elastic_->solve(index_of(b), pull_.data() + begin, moved_.data() + begin);
        for (std::size_t i = begin; i < end; ++i) y[i] += moved_[i];
      });
}

/// d of the rows of a chunk; unless they are of an elastic body also their y, and their part of
/// d . omega D^-1 d.
void TwoLevelStep::step_chunk(std::int64_t c,
                              const std::vector<double>& x,
                              const std::vector<double>& force,
                              std::vector<double>& y) {
  const Chunk& chunk = chunks_[index_of(c)];
  const IslandRange& island = islands_->list()[index_of(chunk.island)];
  const double omega = island.is_coupled ? relaxation_ : 1;
  double* const d = product_.data();
  const std::int64_t end = 3 * std::int64_t{chunk.row_end};
  for (std::int64_t i = 3 * std::int64_t{chunk.row_begin}; i < end; ++i)
    d[i] = force[index_of(i)] - d[i];
  double square = 0;
  squares_[index_of(c)] = 0;
  if (island.elastic >= 0) return;
  for (std::int64_t row = chunk.row_begin; row < chunk.row_end; ++row) {
    double z[6];
    const int count = diagonal_.multiply(row, d + 3 * row, z);
    for (int i = 0; i < count; ++i) {
      y[index_of(3 * row + i)] = x[index_of(3 * row + i)] + omega * z[i];
      square += omega * d[3 * row + i] * z[i];
    }
  }
  squares_[index_of(c)] = square;
}

}  // namespace tetwarp
