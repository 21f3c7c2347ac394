/// @file volume_part.hpp
/// Steps and their blocks between reading and file.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/blocks.hpp>
#include <tetwarp/report.hpp>

#include "host/cli/job/fingerprint.hpp"
#include "host/cli/warp/volumes/samples.hpp"

namespace tetwarp::cli {

/// A step of the mesh that is not written yet.
struct VolumeStep {
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
struct VolumePart {
  std::shared_ptr<VolumeStep> step;
  Region region;                     ///< in the output grid
  std::shared_ptr<Samples> outputs;  ///< null: the file stores none
  bool is_first = true;              ///< of its step
  bool is_last = true;
};

}  // namespace tetwarp::cli
