/// @file memory_plan.hpp
/// Whether a volume and its outputs fit in memory.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/blocks.hpp>

#include "host/cli/job/job_plan.hpp"

namespace tetwarp::cli {

/// Why an output cannot be computed in blocks, with a remedy; empty: it can.
/// @param has_curves  whether the mesh has tetrahedra of ten nodes
std::string needs_all_at_once(const WarpArguments& arguments, bool has_curves = false);

/// Bytes of one voxel of all arrays.
double voxel_bytes(const std::vector<ArrayHeader>& arrays);

/// The warped arrays of a volume, then the extra outputs.
std::vector<ArrayHeader> arrays_written(const VolumePlan& plan, const WarpArguments& arguments);

/// Memory of a run without samples and lists of cells [byte]: of the process as it is now, of code
/// that it loads later, of threads, mesh, caches and buffers of the files.
double fixed_memory(const VolumePlan& plan, const WarpArguments& arguments, const MeshHeader& mesh);

/// Sets `memory`, `memory_limit` and, with --dry-run, `refusal` of a plan. Throws
/// std::invalid_argument, IoError if sources, outputs and extra outputs do not fit in memory; with
/// --memory if they cannot be computed in blocks.
/// @returns whether a second set of outputs also fits
bool plan_memory(VolumePlan& plan,
                 const WarpArguments& arguments,
                 const MeshReader& mesh,
                 const std::vector<std::int64_t>& steps);

/// Space on the disk that temporary files take in addition to the output [byte]: the unpacked
/// source, steps of a series that can be resumed, and NIfTI outputs that are not written from their
/// beginning to their end.
/// @param blocks  of the output; 0: it is computed as a whole
double temporary_disk(const VolumePlan& plan, const WarpArguments& arguments, std::int64_t blocks);

/// The value of --memory that allows so much: "39M".
std::string limit_text(double bytes);

/// Host memory of the largest block of a step that is cut as finely as possible [byte].
double least_block_memory(BlockPlanner& planner,
                          const std::vector<Point3>& positions,
                          BlockLimits limits);

}  // namespace tetwarp::cli
