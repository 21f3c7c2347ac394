/// @file job_plan.hpp
/// What a warp will read, compute and write. Making a plan finds every error that can be found
/// without reading samples, before anything is written.
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <tetwarp/field_reader.hpp>
#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/job/warnings.hpp"
#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// A step of the mesh, and the step of the volume that it warps.
struct WarpStep {
  std::int64_t number;     ///< in names of files and in the report
  std::int64_t mesh_step;  ///< the same, but 0 of a mesh of one step that warps a series
  std::int64_t volume_step;
  double time;  ///< in a series
};

/// One volume file.
struct VolumePlan {
  std::string path;
  VolumeReadOptions read;
  std::vector<ArrayHeader> arrays;  ///< to warp, at least one
  std::vector<FieldReader> fields;  ///< of the links of a transform; empty: a mesh
  std::string active;               ///< VolumeHeader::active
  Grid source_grid;
  Grid output_grid;                  ///< the whole, of which --roi may be a part
  Grid written_grid;                 ///< output_grid, or the part that --roi takes of it
  std::vector<WarpStep> steps;       ///< with several ranks those of this rank
  bool has_one_deformation = false;  ///< the one step of the mesh warps all steps of the volume
  bool is_series = false;            ///< all steps are written to one file
  std::vector<std::string> outputs;  ///< one per step; a single one of a series
  std::vector<std::string> files;    ///< all that are written: of NIfTI one per output and array
  double memory_limit = 0;           ///< limit for computing in blocks [byte]; 0: as a whole
  double memory = 0;                 ///< of the process that computes the whole [byte]
  std::string refusal;               ///< with --dry-run: why it cannot run here
  bool writes_beside = false;        ///< write a step while the next one is computed
  Warnings warnings;
  Warnings notes;  ///< what is left out by design: no error with --strict

  /// Arrays of a series that differ from step to step. The others, of NIfTI images, are written
  /// once.
  std::size_t changing_arrays() const {
    return has_one_deformation ? arrays.size() : std::numeric_limits<std::size_t>::max();
  }
  std::int64_t files_per_output() const { return std::ssize(files) / std::ssize(outputs); }
};

/// A whole job.
struct JobPlan {
  MeshReader mesh;
  std::vector<std::int64_t> steps;  ///< of the mesh, ascending
  Backend backend;                  ///< never automatic
  std::string backend_reason;       ///< why this one
  std::string output_folder;        ///< of several volumes, created when missing; else empty
  std::vector<VolumePlan> volumes;
  Warnings warnings;  ///< those of the volumes included
  Warnings notes;     ///< of the volumes

  std::vector<std::string> outputs() const;
};

/// Names of the output of a volume in a folder.
struct OutputNames {
  std::string of_folder;  ///< where the volume is a folder of DICOM images
  /// Where it is a file: its own name. A pair .hdr and .img and a DICOM image become one file
  /// .nii.gz, a pair of .nhdr and samples .nrrd.
  std::string of_file;
};

OutputNames output_names_of(const std::string& volume);

/// True when the steps of a series are written to files of their own before they are joined, so
/// that --resume can keep them.
bool may_resume_within(const VolumePlan& volume, const WarpArguments& arguments);

/// Reads all file headers and checks all arguments. Throws std::invalid_argument, IoError,
/// CudaError.
JobPlan plan_job(const WarpArguments& arguments);

}  // namespace tetwarp::cli
