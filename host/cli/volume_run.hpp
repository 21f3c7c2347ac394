/// @file volume_run.hpp
/// One volume file warped by every step of a plan; each step is written while the next is computed,
/// on a device beside the copy home of the one between.
#pragma once
#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/page_lock.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/fingerprint.hpp"
#include "host/cli/job_plan.hpp"
#include "host/cli/progress_bar.hpp"
#include "host/cli/warp_job.hpp"

namespace tetwarp::cli {

/// Holds the sources, the outputs and the Warper between steps. All references must outlive it.
///
/// Files are read between the writes, never beside one: HDF5 need not be built for threads.
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
  using Write = std::function<WrittenFile(const StepReport&, const std::vector<const Volume*>&)>;

  void read_sources();
  void write_each_step();
  void write_temporal();
  std::vector<Point3> read_positions(std::int64_t step, StepReport& report) const;
  bool equals_last_step(const std::vector<Point3>& positions) const;
  void compute(std::vector<Point3> positions, StepReport report, Write write);
  void finish_computing();
  void start_warper();
  void finish_step(const StepReport& report);
  void start_writing();
  void finish_writing();
  void write_the_rest();
  Fingerprint fingerprint_of_inputs() const;

  const WarpArguments& arguments_;
  const JobPlan& plan_;
  const VolumePlan& volume_;
  ProgressBar& bar_;
  JobResult& result_;
  std::vector<Volume> sources_;
  std::vector<Point3> last_positions_;  ///< those of the last step that was begun
  StepReport last_report_;              ///< of the last step that was computed

  /// What a step writes to.
  struct Outputs {
    std::vector<Volume> warped;   ///< as sources_, on the written grid
    std::vector<Volume> extra;    ///< in the order of the table
    std::vector<PageLock> locks;  ///< on a device, of all these

    std::vector<const Volume*> volumes() const;
  };
  /// A step, how it gets to its file, and from where.
  struct Step {
    StepReport report;  ///< of a step in flight: about what was read
    Write write;
    std::vector<const Volume*> volumes;
  };
  struct Written {
    WrittenFile file;
    double seconds;
  };
  void make_outputs(Outputs& outputs) const;

  Outputs outputs_[2];
  std::size_t now_ = 0;           ///< the outputs of the last step that was begun
  std::optional<Warper> warper_;  ///< made for the first step; its end waits for steps in flight
  std::optional<TemporalVolumeWriter> temporal_;
  std::optional<Step> begun_;     ///< and not computed yet
  std::optional<Step> computed_;  ///< and not written yet
  StepReport writing_report_;
  std::future<Written> writing_;  ///< last: its end waits for the write, which uses all above
};

}  // namespace tetwarp::cli
