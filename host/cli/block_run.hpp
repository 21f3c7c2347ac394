/// @file block_run.hpp
/// One volume file warped block by block by every step of a plan, because memory does not hold it
/// or because ranks share it: a window of the source is read and the block before is written while
/// a block is computed.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/blocks.hpp>
#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/fingerprint.hpp"
#include "host/cli/job_plan.hpp"
#include "host/cli/progress_bar.hpp"
#include "host/cli/ranks.hpp"
#include "host/cli/warp_job.hpp"

namespace tetwarp::cli {

/// Bytes of an array over a region.
inline std::size_t bytes_of(const ArrayHeader& array, const Region& region) {
  return static_cast<std::size_t>(region.voxel_count() * array.components) * size_of(array.type);
}

/// All references must outlive it. Files have the arrays that VolumeRun would write, bit for bit.
class BlockRun {
 public:
  BlockRun(const WarpArguments& arguments,
           const JobPlan& plan,
           const VolumePlan& volume,
           Ranks& ranks,
           ProgressBar& bar,
           JobResult& result);

  /// Reads, warps and writes; adds what was done to the result.
  void run();

  /// Only says how it would: adds a plan per step to the result.
  void plan_only();

 private:
  /// Samples of all arrays over one region.
  using Samples = std::vector<std::unique_ptr<std::byte[]>>;

  void run_each_step(const Fingerprint& inputs);
  void run_temporal(Fingerprint fingerprint);
  Fingerprint scan_sources();
  BlockPlan plan_step(const std::vector<Point3>& positions);
  BlockLimits limits() const;
  double fixed_bytes() const;
  bool may_keep(const std::string& output, const Fingerprint& fingerprint);
  void begin_file(const std::string& output, const Fingerprint& fingerprint, bool is_temporal);
  Counts finish_file();
  void run_step(const BlockPlan& plan, const std::vector<Point3>& positions, StepReport& report);
  void send(const WarpBlock& block, Samples outputs);
  Samples receive(const WarpBlock& block, int from) const;
  void add_reports_of_others(StepReport& report) const;
  Samples read_window(const Region& window) const;
  Samples compute(const WarpBlock& block,
                  const std::vector<Point3>& positions,
                  const Samples& windows,
                  StepReport& report);
  Samples make_outputs(const Region& region) const;
  void write(const Region& region, const Samples& outputs);
  void finish_step(const StepReport& report);

  const WarpArguments& arguments_;
  const JobPlan& plan_;
  const VolumePlan& volume_;
  Ranks& ranks_;
  ProgressBar& bar_;
  JobResult& result_;
  WarpOptions options_;
  std::vector<ArrayHeader> outputs_;  ///< warped arrays, then the extra ones
  std::vector<VolumeReader> readers_;
  std::vector<std::vector<double>> ranges_;  ///< of the sources, where they are wanted
  std::optional<BlockPlanner> planner_;
  std::optional<BlockVolumeWriter> writer_;  ///< of the root
  Samples sent_;                             ///< on their way to the root
  double fixed_bytes_ = 0;                   ///< memory that is not the blocks'
};

}  // namespace tetwarp::cli
