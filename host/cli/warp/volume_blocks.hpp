/// @file volume_blocks.hpp
/// The blocks in which the steps of a volume are computed.
#pragma once
#include <optional>
#include <vector>

#include <tetwarp/blocks.hpp>

#include "host/cli/common/ranks.hpp"
#include "host/cli/warp/volume_task.hpp"

namespace tetwarp::cli {

/// A whole volume is a single block.
class VolumeBlocks {
 public:
  /// @param task, ranks  kept by the caller; all ranks plan the same blocks
  VolumeBlocks(const VolumeTask& task, const Ranks& ranks);

  /// @throws std::invalid_argument  positions that are not finite or too far from the grid, or
  ///                                memory that is too low, see is_too_low()
  BlockPlan plan(const std::vector<Point3>& positions);

  /// Whether --memory was too low for the smallest blocks of these positions in the last plan().
  bool is_too_low(const std::vector<Point3>& positions);
  /// Throws std::invalid_argument with the least limit that suffices for all steps. Reads the file
  /// of the mesh.
  [[noreturn]] void refuse_limit();

  /// Memory of the process besides that of the blocks [byte]; 0 for a whole volume.
  double fixed_bytes() const { return fixed_bytes_; }
  /// Limit of the memory of the blocks [byte]; infinity: none.
  double host_bytes() const;

  /// Frees the memory of the planner: no block is planned any more.
  void clear() { planner_.reset(); }

 private:
  BlockLimits limits() const;

  const VolumeTask& task_;
  const Ranks& ranks_;
  double fixed_bytes_ = 0;
  std::optional<BlockPlanner> planner_;
  BlockLimits last_limits_;  ///< of the last plan()
};

}  // namespace tetwarp::cli
