/// @file block_warper.hpp
/// Computes the blocks of a volume.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include <tetwarp/blocks.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/warp/volumes/volume_part.hpp"
#include "host/cli/warp/volumes/volume_sources.hpp"
#include "host/cli/warp/volumes/volume_task.hpp"

namespace tetwarp::cli {

/// A whole volume has one Warper, whose outputs are reused so that unchanged work is skipped. Each
/// of several blocks has a Warper and outputs of its own.
class BlockWarper {
 public:
  /// @param task, sources, report  kept by the caller; the report gets facts of the Warper and what
  ///                               blocks read
  BlockWarper(const VolumeTask& task, const VolumeSources& sources, Report& report)
      : task_(task), sources_(sources), report_(report) {}

  /// Computes a block; its step gets the report.
  /// @param windows  of the sources, of several blocks
  /// @returns        the part with its outputs
  VolumePart compute(VolumePart part,
                     const WarpBlock& block,
                     const Samples& windows,
                     const Progress& progress);

  /// Outputs of the last block of a whole volume; else null.
  std::shared_ptr<Samples> last_outputs() const { return kept_[now_]; }

  /// Frees the Warper: the sources change.
  void reset() { warper_.reset(); }

 private:
  void make_warper(const WarpBlock& block, const Samples& windows);
  std::shared_ptr<Samples> outputs_for(const Region& region);
  void end_block(const WarpBlock& block, std::int32_t* owners, Counts& counts);

  const VolumeTask& task_;
  const VolumeSources& sources_;
  Report& report_;
  std::shared_ptr<Samples> kept_[2];    ///< outputs of a whole volume, used alternately
  std::size_t now_ = 0;                 ///< those of the last step
  std::optional<BlockMesh> part_mesh_;  ///< nodes of the block that is computed
  std::optional<Warper> warper_;
};

}  // namespace tetwarp::cli
