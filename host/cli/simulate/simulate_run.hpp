/// @file simulate_run.hpp
/// A simulation from a scene to a folder of results.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>

#include <tetwarp/simulate.hpp>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/common/progress_bar.hpp"
#include "host/cli/simulate/simulate_arguments.hpp"
#include "host/cli/simulate/simulate_bodies.hpp"
#include "host/cli/simulate/simulate_contacts.hpp"
#include "host/cli/simulate/simulate_frames.hpp"
#include "host/cli/simulate/simulate_pictures.hpp"
#include "host/cli/simulate/simulate_report.hpp"
#include "host/cli/simulate/simulate_series.hpp"
#include "host/cli/simulate/simulate_warp.hpp"
#include "io/vtkhdf/simulation_series.hpp"

namespace tetwarp::cli {

/// Steps a scene and writes its frames, series, pictures and warped volumes.
///
/// The constructor finds every error that can be found before a step, and writes nothing.
class SimulateRun {
 public:
  explicit SimulateRun(const SimulateArguments& arguments);

  /// Runs until the last step or an interrupt, then writes the report. Where a step fails, files
  /// hold all steps before it, and the error is thrown after the report says so.
  const SimulateResult& run();

  const Simulator& simulator() const { return *simulator_; }

 private:
  void restore();
  void open_files();
  void write_row();
  void write_frame(std::int64_t frame);
  void write_checkpoint();
  void flush_if_due();
  void flush();
  void take_steps(ProgressBar& bar);
  bool take_step();
  void finish();
  double frame_seconds(std::int64_t frame) const;

  const SimulateArguments& arguments_;
  SimulateResult result_;
  Stopwatch total_;
  std::unique_ptr<Simulator> simulator_;
  std::int64_t last_step_ = 0;
  std::optional<FrameSteps> frames_;
  std::int64_t next_frame_ = 0;
  std::optional<StepSeries> series_;
  std::optional<SeriesWriter> series_file_;
  std::optional<BodyFiles> bodies_;
  std::optional<ContactFile> contacts_;
  std::optional<BodyWarps> warps_;
  std::optional<ScenePictures> pictures_;
  bool has_unwritten_ = false;  ///< rows or frames
  Stopwatch since_flush_;
  double flush_seconds_ = 0;                  ///< of the last flush()
  std::optional<SignalHold> until_complete_;  ///< while files are changed
};

}  // namespace tetwarp::cli
