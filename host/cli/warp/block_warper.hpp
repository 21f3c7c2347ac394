/// @file block_warper.hpp
/// Computes the blocks of a volume.
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include <tetwarp/blocks.hpp>
#include <tetwarp/page_lock.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/warp/volume_part.hpp"
#include "host/cli/warp/volume_sources.hpp"
#include "host/cli/warp/volume_task.hpp"

namespace tetwarp::cli {

/// A whole volume has one Warper, whose outputs are reused so that unchanged work is skipped. Each
/// of several blocks has a Warper and outputs of its own.
class BlockWarper {
 public:
  /// @param task, sources, report  kept by the caller; the report gets facts of the Warper and what
  ///                               blocks read
  BlockWarper(const VolumeTask& task, const VolumeSources& sources, Report& report)
      : task_(task), sources_(sources), report_(report) {}

  /// Begins a block. On a device a second one can be begun before the first one is finished.
  /// @param part     its outputs are set
  /// @param block    kept by the caller until the block is finished
  /// @param windows  of the sources; of several blocks, kept likewise
  void begin(VolumePart part,
             const WarpBlock& block,
             const Samples& windows,
             const Progress& progress);

  /// Blocks that are begun and not finished.
  std::size_t begun_count() const { return begun_.size(); }
  /// The first one of these. @pre begun_count() > 0
  const VolumePart& first_begun() const { return begun_.front().part; }

  /// Finishes the first of these blocks; its step gets the report. @throws the error of the step
  VolumePart finish();

  /// Outputs of the last block that was begun, of a whole volume; else null.
  std::shared_ptr<Samples> last_outputs() const { return kept_[now_]; }

  /// Frees the Warper: the sources change. @pre begun_count() == 0
  void reset() { warper_.reset(); }

 private:
  struct Begun {
    VolumePart part;
    const WarpBlock* block;
    std::int32_t* owners;  ///< array of the outputs; null: not written
  };

  void make_warper(const WarpBlock& block, const Samples& windows);
  std::shared_ptr<Samples> outputs_for(const Region& region);
  void end_block(const Begun& begun);

  const VolumeTask& task_;
  const VolumeSources& sources_;
  Report& report_;
  std::shared_ptr<Samples> kept_[2];    ///< outputs of a whole volume, used alternately
  std::size_t now_ = 0;                 ///< those of the last step that was begun
  std::vector<PageLock> locks_;         ///< of kept_, where a device copies to them
  std::optional<BlockMesh> part_mesh_;  ///< nodes and cells of the block that is computed
  std::deque<Begun> begun_;
  std::optional<Warper> warper_;  ///< last member: its destructor waits for steps in flight
};

}  // namespace tetwarp::cli
