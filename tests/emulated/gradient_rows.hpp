/// @file gradient_rows.hpp
/// Positive definite systems of 3x3 blocks for conjugate gradients of the emulated device, on the
/// host's own arrays.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"

#include "kernels/body/island_team.cuh"

namespace tetwarp::test {

/// One island; every fifth row and the next one are of a rigid body. Rows are coupled to those
/// before and after them and to the seventh.
template <class T>
class GradientRows {
 public:
  explicit GradientRows(std::int32_t count) : count_(count) {
    std::mt19937 random(static_cast<unsigned>(count));
    std::uniform_real_distribution<double> number(-1, 1);
    for (std::int32_t row = 0; row < count; ++row) {
      const bool is_first = row % 5 == 2 && row + 1 < count, is_second = row % 5 == 3;
      pair_.push_back(is_first ? 1 : is_second ? 2 : 0);
      if (is_first || is_second) ++pair_rows_;
      start_.push_back(static_cast<std::int32_t>(column_.size()));
      for (const std::int32_t other : {row - 7, row - 1, row, row + 1, row + 7}) {
        if (other < 0 || other >= count) continue;
        if (other == row) diagonal_.push_back(static_cast<std::int32_t>(column_.size()));
        column_.push_back(other);
        add_block(row, other);
      }
    }
    start_.push_back(static_cast<std::int32_t>(column_.size()));
    free_end_.assign(start_.begin() + 1, start_.end());
    number_blocks();
    for (std::int32_t i = 0; i < 3 * count; ++i) load.push_back(number(random));
    x.assign(load.size(), 0.0);
    copy_.assign(values_.begin(), values_.end());
    inverse_.assign(index_of(9 * std::int64_t{count} + 18 * std::int64_t{pair_rows_}), T(0));
    for (auto* vector : {&r_, &z_, &p_, &q_}) vector->assign(load.size(), T(0));
    for (std::int32_t row = 0; row < count; ++row) {
      RowInvertOp<T>{rows(), view_of(std::as_const(values_)), views().inverse}(row);
    }
  }

  std::vector<double> load, x;

  std::int32_t count() const { return count_; }
  GradientArrays<T> views() {
    GradientArrays<T> a;
    a.rows = rows();
    a.values = view_of(std::as_const(values_));
    a.copy = view_of(std::as_const(copy_));
    a.inverse = {view_of(std::as_const(pair_)), view_of(std::as_const(block_of_)), count_,
                 count_ - pair_rows_, view_of(inverse_)};
    a.load = view_of(std::as_const(load));
    a.x = view_of(x);
    a.r = view_of(r_);
    a.z = view_of(z_);
    a.p = view_of(p_);
    a.q = view_of(q_);
    return a;
  }
  /// The largest number of b - A x.
  double residual() const {
    double largest = 0;
    for (std::int32_t row = 0; row < count_; ++row) {
      double product[3];
      multiply_blocks(values_.data(), column_.data(), start_[index_of(row)],
                      free_end_[index_of(row)], x.data(), product);
      for (int i = 0; i < 3; ++i) {
        const double left = load[index_of(3 * row + i)] - product[i];
        largest = left == left ? std::max(largest, std::fabs(left)) : INFINITY;
      }
    }
    return largest;
  }

  /// Solves from zero by one block.
  template <int threads>
  GradientEnd by_block(double tolerance) {
    x.assign(x.size(), 0.0);
    GradientEnd end;
    const IslandRows island = {0, count_};
    simt::launch(island_cg_kernel<T, threads>, dim3(1), dim3(threads),
                 TeamOfBlock<threads>::shared_bytes, views(), View<const IslandRows>{&island, 1},
                 GradientOptions{tolerance}, View<GradientEnd>{&end, 1});
    return end;
  }
  GradientEnd by_grid(double tolerance, unsigned blocks) {
    x.assign(x.size(), 0.0);
    GradientEnd end;
    std::vector<LargestSum> sums(
        index_of(GridTeam::sum_bytes(count_) / static_cast<std::int64_t>(sizeof(LargestSum))));
    simt::launch_cooperative(island_cg_grid_kernel<T>, dim3(blocks), dim3(sum_threads),
                             GridTeam::shared_bytes, views(), IslandRows{0, count_},
                             GradientOptions{tolerance}, static_cast<void*>(sums.data()),
                             View<GradientEnd>{&end, 1});
    return end;
  }

 private:
  SystemRows rows() const {
    SystemRows rows;
    rows.count = rows.unknown_count = count_;
    rows.block_of = view_of(block_of_);
    rows.start = view_of(start_);
    rows.free_end = view_of(free_end_);
    rows.column = view_of(column_);
    rows.diagonal = view_of(diagonal_);
    rows.pair = view_of(pair_);
    return rows;
  }
  /// Symmetric, and more on the diagonal than in the rest of a row.
  void add_block(std::int32_t row, std::int32_t other) {
    for (int column = 0; column < 3; ++column) {
      for (int i = 0; i < 3; ++i) {
        const double on_diagonal = row == other ? 4.5 + 0.5 * i + row % 3 : 0.4;
        values_.push_back(i == column ? on_diagonal : 0.25);
      }
    }
  }
  /// Blocks of nodes come before those of rigid bodies, which have two each.
  void number_blocks() {
    std::int32_t node = 0, rigid = count_ - pair_rows_;
    for (const std::uint8_t pair : pair_) block_of_.push_back(pair == 0 ? node++ : rigid++);
  }

  std::int32_t count_, pair_rows_ = 0;
  std::vector<std::int32_t> block_of_, start_, free_end_, column_, diagonal_;
  std::vector<std::uint8_t> pair_;
  std::vector<double> values_;
  std::vector<T> copy_, inverse_, r_, z_, p_, q_;
};

}  // namespace tetwarp::test
