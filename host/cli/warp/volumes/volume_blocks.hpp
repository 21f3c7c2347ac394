/// @file volume_blocks.hpp
/// The blocks in which the steps of a volume are computed.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include <tetwarp/blocks.hpp>

#include "host/cli/common/ranks.hpp"
#include "host/cli/warp/volumes/volume_task.hpp"

namespace tetwarp::cli {

/// A whole volume is a single block.
class VolumeBlocks {
 public:
  /// @param task, ranks  kept by the caller; all ranks plan the same blocks
  VolumeBlocks(const VolumeTask& task, const Ranks& ranks);

  /// @param before_reading  called before the file of the mesh is read, which is done where memory
  ///                        is too low
  /// @throws std::invalid_argument  positions that are not finite or too far from the grid; memory
  ///                                that is too low, with the least limit for all steps
  BlockPlan plan(const std::vector<Point3>& positions, const std::function<void()>& before_reading);

  /// Memory of the process besides that of the blocks [byte]; 0 for a whole volume.
  double fixed_bytes() const { return fixed_bytes_; }
  /// Limit of the memory of the blocks [byte]; infinity: none.
  double host_bytes() const;

  /// Frees the memory of the planner: no block is planned any more.
  void clear() { planner_.reset(); }

 private:
  BlockLimits limits() const;
  [[noreturn]] void refuse(const BlockLimits& limits);

  const VolumeTask& task_;
  const Ranks& ranks_;
  double fixed_bytes_ = 0;
  std::optional<BlockPlanner> planner_;
};

}  // namespace tetwarp::cli
