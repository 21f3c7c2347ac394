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

/// Divides the rows; both rows of a rigid body are in one chunk.
void TwoLevelStep::list_chunks() {
  if (version_ == lists_->version) return;
  version_ = lists_->version;
  chunks_.clear();
  const auto count = static_cast<std::int32_t>(lists_->row_count());
  const SystemRows& all = system_->rows;
  for (std::int32_t row = 0; row < count; ++row) {
    const std::int32_t place = lists_->system_row[index_of(row)];
    const bool is_elastic = lists_->body_at(row).frame >= 0;
    const bool follows = row > 0 && chunks_.back().is_elastic == is_elastic &&
                         place - chunks_.back().system_row == row - chunks_.back().row_begin;
    const bool has_room =
        follows && (row - chunks_.back().row_begin < chunk_rows || all.pair[place] == 2);
    if (!has_room) chunks_.push_back({row, row, place, is_elastic});
    chunks_.back().row_end = row + 1;
  }
  squares_.resize(chunks_.size());
}

void TwoLevelStep::set(const StepSystem& system,
                       const CompliantLists& lists,
                       ElasticSpace& elastic,
                       std::vector<double>& weights) {
  const SystemRows& all = system.rows;
  system_ = &system;
  lists_ = &lists;
  elastic_ = &elastic;
  list_chunks();
  inverse_.resize(
      index_of(9 * std::int64_t{all.unknown_count} + 36 * std::int64_t{model_.rigid_count}));
  diagonal_ = {all.pair,
               all.block_of,
               all.unknown_count,
               model_.node_count,
               {inverse_.data(), static_cast<std::int64_t>(inverse_.size())}};
  const std::int64_t numbers = 3 * lists.row_count();
  for (auto* values : {&product_, &pull_, &moved_, &weights}) values->resize(index_of(numbers));
  const RowInvertOp<double> invert{all, system.values, diagonal_};
  parallel_tasks(threads_, static_cast<std::int64_t>(chunks_.size()), [&](std::int64_t c) {
    const Chunk& chunk = chunks_[index_of(c)];
    for (std::int32_t row = chunk.row_begin; row < chunk.row_end; ++row) {
      const std::int32_t place = chunk.system_row + row - chunk.row_begin;
      invert(place);
      const double* const own = system.values.data + 9 * std::int64_t{all.diagonal[place]};
      for (int i = 0; i < 3; ++i) weights[index_of(3 * std::int64_t{row} + i)] = own[4 * i];
    }
  });
}

double TwoLevelStep::run(const std::vector<double>& x,
                         const std::vector<double>& force,
                         std::vector<double>& y) {
  parallel_tasks(threads_, static_cast<std::int64_t>(chunks_.size()),
                 [&](std::int64_t c) { step_chunk(c, x, force, y); });
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
        const double* const pull = pull_.data();
        if (std::all_of(pull + begin, pull + end, [](double value) { return value == 0; })) return;
        elastic_->solve(index_of(b), pull + begin, moved_.data() + begin);
        for (std::size_t i = begin; i < end; ++i) y[i] += moved_[i];
      });
}

void TwoLevelStep::multiply_chunk(const Chunk& chunk, const double* x, double* out) const {
  const std::int64_t shift = 3 * (std::int64_t{chunk.row_begin} - chunk.system_row);
  GradientArrays<double> a;
  a.rows = system_->rows;
  a.values = a.copy = system_->values;
  // Columns of the system are rows of the same island.
  a.p.data = const_cast<double*>(x) + shift;  // only read
  a.q.data = out + shift;
  vector_stages().product(a, chunk.system_row, chunk.system_row + chunk.row_end - chunk.row_begin);
}

/// out = omega D^-1 push of the rows of a chunk, unless they are of an elastic body.
void TwoLevelStep::solve_chunk(const Chunk& chunk, const double* push, double* out) const {
  for (std::int64_t row = chunk.row_begin; row < chunk.row_end && !chunk.is_elastic; ++row) {
    const double omega = lists_->body_at(row).relaxation;
    double* const own = out + 3 * row;
    const int count =
        diagonal_.multiply(row + chunk.system_row - chunk.row_begin, push + 3 * row, own);
    for (int i = 0; i < count; ++i) own[i] *= omega;
  }
}

/// d of the rows of a chunk; unless they are of an elastic body also their y, and their part of
/// d . omega D^-1 d.
void TwoLevelStep::step_chunk(std::int64_t c,
                              const std::vector<double>& x,
                              const std::vector<double>& force,
                              std::vector<double>& y) {
  const Chunk& chunk = chunks_[index_of(c)];
  multiply_chunk(chunk, x.data(), product_.data());
  const std::size_t begin = 3 * index_of(chunk.row_begin), end = 3 * index_of(chunk.row_end);
  for (std::size_t i = begin; i < end; ++i) product_[i] = force[i] - product_[i];
  squares_[index_of(c)] = 0;
  if (chunk.is_elastic) return;
  solve_chunk(chunk, product_.data(), moved_.data());
  double square = 0;
  for (std::size_t i = begin; i < end; ++i) {
    y[i] = x[i] + moved_[i];
    square += product_[i] * moved_[i];
  }
  squares_[index_of(c)] = square;
}

void TwoLevelStep::multiply(const double* x, double* out) const {
  parallel_tasks(threads_, static_cast<std::int64_t>(chunks_.size()),
                 [&](std::int64_t c) { multiply_chunk(chunks_[index_of(c)], x, out); });
}

void TwoLevelStep::solve(const double* push, double* out) const {
  parallel_tasks(threads_, static_cast<std::int64_t>(chunks_.size()),
                 [&](std::int64_t c) { solve_chunk(chunks_[index_of(c)], push, out); });
  parallel_tasks(
      threads_, static_cast<std::int64_t>(elastic_->bodies().size()), [&](std::int64_t b) {
        const std::int64_t first = 3 * std::int64_t{elastic_->bodies()[index_of(b)].row_begin};
        elastic_->solve(index_of(b), push + first, out + first);
      });
}

}  // namespace tetwarp
