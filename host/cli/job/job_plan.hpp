/// @file job_plan.hpp
/// What a warp will read, compute and write. Making a plan finds every error that can be found
/// without reading samples, before anything is written.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/job/warnings.hpp"
#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// One volume file.
struct VolumePlan {
  std::string path;
  VolumeReadOptions read;
  std::vector<ArrayHeader> arrays;  ///< to warp, at least one
  std::string active;               ///< VolumeHeader::active
  Grid source_grid;
  Grid output_grid;                  ///< the whole, of which --roi may be a part
  Grid written_grid;                 ///< output_grid, or the part that --roi takes of it
  std::vector<std::int64_t> steps;   ///< of the mesh; with several ranks those of this rank
  std::vector<std::string> outputs;  ///< one per step; a single one with --temporal
  std::vector<std::string> files;    ///< all that are written: of NIfTI one per output and array
  double memory_limit = 0;           ///< limit for computing in blocks [byte]; 0: as a whole
  double memory = 0;                 ///< of the process that computes the whole [byte]
  std::string refusal;               ///< with --dry-run: why it cannot run here
  bool writes_beside = false;        ///< write a step while the next one is computed
  bool overlaps = false;             ///< begin a step before the previous one is copied to the host
  Warnings warnings;

  std::int64_t files_per_output() const { return std::ssize(files) / std::ssize(outputs); }
};

/// A whole job.
struct JobPlan {
  MeshReader mesh;
  std::vector<std::int64_t> steps;  ///< ascending
  Backend backend;                  ///< never automatic
  std::string backend_reason;       ///< why this one
  std::string output_folder;        ///< created when missing; empty: it exists
  std::vector<VolumePlan> volumes;
  Warnings warnings;  ///< those of the volumes included

  std::vector<std::string> outputs() const;
};

/// True when the steps of a series are written to files of their own before they are joined, so
/// that --resume can keep them.
bool may_resume_within(const VolumePlan& volume, const WarpArguments& arguments);

/// Reads all file headers and checks all arguments. Throws std::invalid_argument, IoError,
/// CudaError.
JobPlan plan_job(const WarpArguments& arguments);

}  // namespace tetwarp::cli
