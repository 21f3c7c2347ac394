/// @file job_plan.hpp
/// What a warp will read, compute and write. Making a plan finds every error that can be found
/// without reading samples; nothing has been written by then.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/warp_arguments.hpp"

namespace tetwarp::cli {

/// One volume file.
struct VolumePlan {
  std::string path;
  std::vector<ArrayHeader> arrays;  ///< to warp, at least one
  Grid source_grid;
  Grid output_grid;  ///< before the region cuts it
  Grid written_grid;
  std::vector<std::int64_t> steps;   ///< of the mesh; of several ranks each has its own
  std::vector<std::string> outputs;  ///< one per step; a single one with --temporal
  double memory_limit = 0;           ///< to compute in blocks within it; 0: all fits
  double memory = 0;                 ///< that all would take at once
  bool writes_beside =
      false;              ///< there is time and memory to write a step while the next is computed
  bool overlaps = false;  ///< the next step is begun before a step is brought home and written
};

/// A whole job.
struct JobPlan {
  MeshReader mesh;
  std::vector<std::int64_t> steps;  ///< ascending
  Backend backend;                  ///< cuda, cpu or reference
  std::string backend_reason;       ///< why this one
  std::string output_folder;        ///< to create when missing; empty: none
  std::vector<VolumePlan> volumes;

  std::vector<std::string> outputs() const;
};

/// Looks at every file and checks every argument. Throws std::invalid_argument, IoError, CudaError.
JobPlan plan_job(const WarpArguments& arguments);

}  // namespace tetwarp::cli
