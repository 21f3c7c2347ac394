/// @file transform_run.hpp
/// Resamples the steps of a volume by a transform: as a whole, or in parts within a limit of
/// memory.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/resample.hpp>
#include <tetwarp/transform_file.hpp>

#include "host/cli/common/progress_bar.hpp"
#include "host/cli/job/job_plan.hpp"
#include "host/cli/job/job_result.hpp"
#include "host/cli/job/output_writer.hpp"
#include "host/cli/job/warp_arguments.hpp"
#include "host/cli/warp/transform_chain.hpp"
#include "host/cli/warp/warp_job.hpp"
#include "host/warp/resample_blocks.hpp"

namespace tetwarp::cli {

/// The volume to resample.
struct TransformSource {
  VolumeReadOptions read;
  VolumeHeader header;
  std::vector<ArrayHeader> arrays;
  std::optional<Point3> world;  ///< itk_factor() of its positions
  std::vector<std::int64_t> steps;
  bool is_series = false;
};

/// One job. As a whole one array of a step is in memory at a time, and all displacements; in parts
/// windows of them. A transform that leads from the source to the output becomes a field on the
/// grid of the output first, which is in memory as a whole.
class TransformRun {
 public:
  /// Opens the transform and plans memory and disk.
  /// @param arguments, source  kept by the caller
  /// @throws IoError, std::invalid_argument  what open_transform() throws; a job that does not fit
  ///                                         in memory and cannot be computed in parts
  TransformRun(const WarpArguments& arguments,
               const TransformSource& source,
               const ResampleOptions& options);

  /// What the transform was taken for, after a run also how exactly it was inverted.
  std::string convention() const;

  /// Of --dry-run: states memory and parts of all steps, and why they cannot run here.
  void plan(JobResult& result);

  void run(const JobContext& context, JobResult& result);

 private:
  bool is_whole() const { return plan_.memory_limit == 0; }
  /// Whether the file says that the transform, or a part of it, leads from the source to the
  /// output.
  bool inverts() const;
  void plan_memory();
  void read_fields();
  void invert();
  PartLimits limits() const;
  ResampleBlocks blocks(const PartLimits& limits) const;
  double least_part_bytes() const;
  std::optional<ResamplePart> next_part(ResampleBlocks& blocks) const;
  StepPlan plan_of_a_step() const;
  void run_step(std::int64_t step, OutputWriter& writer, ProgressBar& bar);
  void run_parts(std::int64_t step, OutputWriter& writer, ProgressBar& bar, JobResult& result);

  const WarpArguments& arguments_;
  const TransformSource& source_;
  TransformReadOptions read_;  ///< of the transform
  TransformParts parts_;
  ResampleOptions options_;
  VolumePlan plan_;
  ChainNotes notes_;        ///< of an inverse
  double fixed_bytes_ = 0;  ///< memory of the process beside samples and displacements
};

}  // namespace tetwarp::cli
