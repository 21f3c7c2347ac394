/// @file volume_run.hpp
/// One volume file warped by every step of a plan, block by block. Reading, computing and writing
/// overlap. A volume that fits in memory is a single block.
#pragma once
#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/blocks.hpp>
#include <tetwarp/io.hpp>
#include <tetwarp/page_lock.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/common/progress_bar.hpp"
#include "host/cli/common/ranks.hpp"
#include "host/cli/warp/fingerprint.hpp"
#include "host/cli/warp/io_thread.hpp"
#include "host/cli/warp/job_plan.hpp"
#include "host/cli/warp/output_writer.hpp"
#include "host/cli/warp/warp_job.hpp"

namespace tetwarp::cli {

inline std::size_t bytes_of(const ArrayHeader& array, const Region& region) {
  return static_cast<std::size_t>(region.voxel_count() * array.components) * size_of(array.type);
}

/// All references must outlive it. The arrays of the output files do not depend on the blocks.
///
/// The calling thread computes. A second thread reads and writes files; the calling thread does so
/// only while the second one is idle. Blocks are assigned to ranks round-robin, and the root writes
/// them.
///
/// A whole volume: sources stay in memory, one Warper computes all steps, and its outputs are
/// reused, so that unchanged work is skipped. A step is written while the next one is computed; on
/// a device the next one is begun before the copy of this one to the host.
///
/// Several blocks: each has a window of the sources and a Warper. While a block is computed, the
/// previous one is written and the window of the next one is read; steps do not overlap.
class VolumeRun {
 public:
  VolumeRun(const WarpArguments& arguments,
            const JobPlan& plan,
            const VolumePlan& volume,
            Ranks& ranks,
            ProgressBar& bar,
            JobResult& result);

  /// Reads, warps and writes; adds what was done to the result.
  void run();

  /// For --dry-run: adds a plan per step to the result.
  void plan_only();

 private:
  /// Samples of all arrays over one region.
  using Samples = std::vector<std::unique_ptr<std::byte[]>>;

  /// Windows of the sources and the seconds that reading them took.
  struct Windows {
    Samples samples;
    double seconds = 0;
  };

  /// A step of the mesh that is not written yet.
  struct Step {
    std::vector<Point3> positions;
    BlockPlan plan;
    StepReport report;
    double time = 0;            ///< of the step in a temporal file
    std::string output;         ///< file of the step's own; empty in a temporal file
    Fingerprint fingerprint{};  ///< of `output`
    bool is_repeat = false;     ///< equals the step before: a temporal file stores no samples

    // Used by the thread for files until the step is written.
    Counts written{};
    double write_seconds = 0;
  };

  /// A block of a step that is not written yet.
  struct Part {
    std::shared_ptr<Step> step;
    Region region;                     ///< in the output grid
    std::shared_ptr<Samples> outputs;  ///< null: the file stores none
    bool is_first = true;              ///< of its step
    bool is_last = true;
  };

  // volume_run.cpp: sources, steps and files.
  void open_readers(std::int64_t source_step);
  Fingerprint take_sources(std::int64_t source_step);
  Fingerprint read_sources(std::int64_t source_step);
  Fingerprint scan_sources();
  void run_each_step();
  void run_temporal();
  std::shared_ptr<Step> read_step(std::int64_t number);
  bool may_keep(const std::string& output, const Fingerprint& fingerprint);
  std::int64_t files_per_output() const;
  void begin_file(const std::string& output, const Fingerprint& fingerprint, bool is_temporal);
  void finish_step(const StepReport& report);
  BlockLimits limits() const;
  BlockPlan plan_step(const std::vector<Point3>& positions);
  void check_limit(const std::vector<Point3>& positions, const BlockLimits& limits);

  // volume_run_parts.cpp: a series that can be resumed.
  void run_in_parts(const Fingerprint& fingerprint);
  void copy_part(const std::string& part);

  // volume_run_step.cpp: the blocks of a step are read and computed.
  void run_step(const std::shared_ptr<Step>& step);
  bool equals_last_step(const Step& step) const;
  void repeat_step(const std::shared_ptr<Step>& step);
  void run_blocks(const std::shared_ptr<Step>& step);
  std::future<Windows> begin_reading(const Step& step, std::size_t block);
  void compute(Part part, const WarpBlock& block, const Samples& windows);
  void make_warper(const WarpBlock& block, const Samples& windows);
  std::shared_ptr<Samples> outputs_for(const Region& region);
  Progress progress_of(const Part& part) const;
  Samples read_windows(const Region& window) const;
  Samples make_outputs(const Region& region) const;

  // volume_run_queue.cpp: blocks are finished, written or sent to the root.
  void finish_computing();
  void start_writing();
  void finish_writing();
  void finish_all();
  void write(const Part& part);
  void send(const Part& part);
  std::shared_ptr<Samples> receive(const Region& region, int from) const;
  void add_reports_of_others(StepReport& report) const;

  const WarpArguments& arguments_;
  const JobPlan& plan_;
  const VolumePlan& volume_;
  Ranks& ranks_;
  ProgressBar& bar_;
  JobResult& result_;
  WarpOptions options_;
  Region region_;                      ///< of the output grid: all that is computed
  bool is_whole_;                      ///< a single block; sources, Warper and outputs are reused
  bool writes_beside_;                 ///< a block is written while the next is computed
  bool overlaps_;                      ///< a step is begun before the one before is finished
  std::vector<ArrayHeader> outputs_;   ///< warped arrays, then the extra ones
  double fixed_bytes_ = 0;             ///< memory besides that of the blocks
  std::int64_t source_step_ = -1;      ///< of the volume, whose samples are the sources; -1: none
  Fingerprint inputs_;                 ///< of these sources and of the options
  std::vector<Volume> sources_;        ///< of a whole volume
  std::vector<VolumeReader> readers_;  ///< of the sources of blocks
  std::vector<std::vector<double>> ranges_;  ///< of these, for --overshoot clamp
  std::optional<BlockPlanner> planner_;
  std::optional<OutputWriter> writer_;  ///< of the root; used by the thread for files

  std::shared_ptr<Samples> kept_[2];    ///< outputs of a whole volume, used alternately
  std::size_t now_ = 0;                 ///< those of the last step that was begun
  std::vector<PageLock> locks_;         ///< of kept_, where a device copies to them
  std::shared_ptr<Samples> sent_;       ///< being sent to the root
  std::optional<BlockMesh> part_mesh_;  ///< nodes and cells of the block that is computed

  std::shared_ptr<Step> last_;    ///< the last step that was begun
  std::optional<Part> begun_;     ///< not computed yet
  std::optional<Part> computed_;  ///< not being written yet
  Part writing_part_;
  std::future<void> writing_;
  std::optional<Warper> warper_;  ///< destroyed before the outputs: waits for steps in flight
  IoThread files_;  ///< destroyed first: waits for its task, which uses the other members
};

}  // namespace tetwarp::cli
