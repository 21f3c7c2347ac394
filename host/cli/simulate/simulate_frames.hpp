/// @file simulate_frames.hpp
/// Which steps of a simulation are written, and names in its files.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/scene.hpp>

namespace tetwarp::cli {

/// Steps whose states are frames of the output: frame k of a rate is step
/// round(k / (rate time_step)); the first and the last step are frames in any case.
class FrameSteps {
 public:
  FrameSteps(const SceneOutput& output, double time_step, std::int64_t step_count);

  std::int64_t count() const { return count_; }
  /// The step of a frame, from 0 to count() - 1.
  std::int64_t step_of(std::int64_t frame) const;
  /// Frames up to and including a step.
  std::int64_t count_through(std::int64_t step) const;

 private:
  double interval_;  ///< steps from frame to frame, >= 1
  std::int64_t step_count_;
  std::int64_t count_;
};

/// Warnings of frames of an earlier, longer run beside those that this run has written, one for
/// each kind of file.
/// @param written  files of this run, NAME_NNNN.EXTENSION
/// @param next     number of the frame after the last one
std::vector<std::string> older_frames(const std::vector<std::string>& written, std::int64_t next);

/// Names of the couplings in files: their own or "a-b"; further ones of the same name get "_2",
/// "_3" and so on.
std::vector<std::string> coupling_names(const Scene& scene);

/// Names of the obstacles in files: their own or "obstacle" and their number.
std::vector<std::string> obstacle_names(const Scene& scene);

}  // namespace tetwarp::cli
