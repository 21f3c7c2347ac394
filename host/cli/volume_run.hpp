/// @file volume_run.hpp
/// One volume file warped by every step of a plan.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/fingerprint.hpp"
#include "host/cli/job_plan.hpp"
#include "host/cli/progress_bar.hpp"
#include "host/cli/warp_job.hpp"

namespace tetwarp::cli {

/// Holds the sources, the outputs and the Warper between steps. All references must outlive it.
class VolumeRun {
 public:
  VolumeRun(const WarpArguments& arguments,
            const JobPlan& plan,
            const VolumePlan& volume,
            ProgressBar& bar,
            JobResult& result);

  /// Reads, warps and writes; adds what was done to the result.
  void run();

 private:
  void read_sources();
  void write_each_step();
  void write_temporal();
  std::vector<Point3> read_positions(std::int64_t step, StepReport& report) const;
  bool is_up_to_date(const std::string& output, const std::string& fingerprint) const;
  bool equals_last_step(const std::vector<Point3>& positions) const;
  void compute(std::vector<Point3> positions, StepReport& report);
  void start_warper();
  void finish_step(const StepReport& report);
  Fingerprint fingerprint_of_inputs() const;
  std::vector<const Volume*> targets() const;
  VolumeWriteOptions write_options(const Fingerprint& fingerprint) const;

  const WarpArguments& arguments_;
  const JobPlan& plan_;
  const VolumePlan& volume_;
  ProgressBar& bar_;
  JobResult& result_;
  std::vector<Volume> sources_;
  std::vector<Volume> warped_;  ///< as sources_, on the written grid
  std::optional<Volume> mask_;
  std::optional<Volume> tet_;
  std::optional<Warper> warper_;        ///< made for the first step that is computed
  std::vector<Point3> last_positions_;  ///< those of what the outputs hold now
  StepReport last_report_;
};

}  // namespace tetwarp::cli
