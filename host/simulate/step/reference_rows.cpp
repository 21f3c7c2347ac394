/// @file reference_rows.cpp
/// Copies the blocks that are not zero.
#include "host/simulate/step/reference_rows.hpp"

#include <utility>

#include "host/base/vector_view.hpp"

namespace tetwarp {
namespace {

using Index = Eigen::Index;

/// Blocks of a body of the model, in ascending order.
std::vector<std::int32_t> blocks_of(const Model& model, std::size_t body) {
  std::vector<std::int32_t> blocks;
  for (std::int32_t n = model.body_node[body]; n < model.body_node[body + 1]; ++n) {
    blocks.push_back(n);
  }
  if (model.body_rigid[body] >= 0) {
    const std::int32_t linear = model.node_count + 2 * model.body_rigid[body];
    blocks.insert(blocks.end(), {linear, linear + 1});
  }
  return blocks;
}

}  // namespace

ReferenceRows::ReferenceRows(const Model& model, std::vector<Index> blocks)
    : blocks_(std::move(blocks)) {
  for (std::int32_t island = 0; island < model.island_count; ++island) {
    for (std::size_t body = 0; body < model.body_island.size(); ++body) {
      if (model.body_island[body] != island) continue;
      for (const std::int32_t block : blocks_of(model, body)) {
        if (model.prescribed[static_cast<std::size_t>(block)] == 0) block_of_.push_back(block);
      }
    }
  }
  unknown_count_ = static_cast<std::int32_t>(block_of_.size());
  for (std::size_t block = 0; block < model.prescribed.size(); ++block) {
    if (model.prescribed[block] != 0) block_of_.push_back(static_cast<std::int32_t>(block));
  }
  for (const std::int32_t block : block_of_) {
    const bool is_rigid = block >= model.node_count;
    pair_.push_back(is_rigid ? static_cast<std::uint8_t>(1 + (block - model.node_count) % 2) : 0);
  }
}

void ReferenceRows::set(const reference::LinearSystem& linear,
                        const reference::VectorXd& velocity) {
  for (auto* list : {&start_, &free_end_, &column_, &diagonal_}) list->clear();
  for (auto* list : {&values_, &load_, &velocity_}) list->clear();
  start_.push_back(0);
  for (std::size_t row = 0; row < block_of_.size(); ++row) {
    add_row(linear, velocity, static_cast<std::int32_t>(row));
  }
}

void ReferenceRows::add_row(const reference::LinearSystem& linear,
                            const reference::VectorXd& velocity,
                            std::int32_t row) {
  const auto block_of = [&](std::int32_t r) {
    return 3 * blocks_[static_cast<std::size_t>(block_of_[static_cast<std::size_t>(r)])];
  };
  const Index own = block_of(row);
  reference::Vector3d load = linear.right.segment<3>(own);
  const auto count = static_cast<std::int32_t>(block_of_.size());
  for (std::int32_t column = 0; column < count; ++column) {
    if (column == unknown_count_) free_end_.push_back(static_cast<std::int32_t>(column_.size()));
    const reference::Matrix3d block = linear.matrix.block<3, 3>(own, block_of(column));
    if (column == row) diagonal_.push_back(static_cast<std::int32_t>(column_.size()));
    if (column != row && block.isZero(0)) continue;
    column_.push_back(column);
    values_.insert(values_.end(), block.data(), block.data() + 9);
    if (row < unknown_count_ && column >= unknown_count_) {
      load -= block * velocity.segment<3>(block_of(column));
    }
  }
  if (unknown_count_ == count) free_end_.push_back(static_cast<std::int32_t>(column_.size()));
  start_.push_back(static_cast<std::int32_t>(column_.size()));
  const reference::Vector3d own_velocity = velocity.segment<3>(own);
  load_.insert(load_.end(), load.data(), load.data() + 3);
  velocity_.insert(velocity_.end(), own_velocity.data(), own_velocity.data() + 3);
}

StepSystem ReferenceRows::system() const {
  StepSystem system;
  system.rows.count = static_cast<std::int32_t>(block_of_.size());
  system.rows.unknown_count = unknown_count_;
  system.rows.block_of = view_of(block_of_);
  system.rows.start = view_of(start_);
  system.rows.free_end = view_of(free_end_);
  system.rows.column = view_of(column_);
  system.rows.diagonal = view_of(diagonal_);
  system.rows.pair = view_of(pair_);
  system.values = view_of(values_);
  system.load = view_of(load_);
  system.velocity = view_of(velocity_);
  return system;
}

}  // namespace tetwarp
