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
std::string needs_all_at_once(const WarpArguments& arguments);

/// Whether the processes of mpirun compute the blocks of a volume's only output; else each takes
/// whole outputs.
bool shares_blocks(const VolumePlan& plan, const WarpArguments& arguments, int processes);

/// Bytes of one voxel of all arrays.
double voxel_bytes(const std::vector<ArrayHeader>& arrays);

/// The warped arrays of a volume, then the extra outputs.
std::vector<ArrayHeader> arrays_written(const VolumePlan& plan, const WarpArguments& arguments);

/// Memory of a run without samples, displacements and lists of cells [byte]: of the process as it
/// is now, of code that it loads later, of threads, mesh, caches and buffers of the files.
double fixed_memory(const VolumePlan& plan, const WarpArguments& arguments, const MeshHeader& mesh);

/// Memory of the nodes on edges of tetrahedra [byte].
double curve_memory(const MeshReader& mesh);

/// Memory per output voxel of owners that no output holds, but voxels outside, labels by Gaussian
/// weights or curved maps depend on [byte].
double owner_bytes(const WarpArguments& arguments, const MeshReader& mesh);

/// Refuses a job: as `refusal` of its plan with --dry-run, else throws std::invalid_argument.
void refuse(VolumePlan& plan, const WarpArguments& arguments, const std::string& reason);

/// Sets `memory_limit` of a plan whose `memory` is known. Refuses what does not fit.
/// @throws IoError  with --memory when it cannot be computed in blocks
/// @returns memory that the process may take [byte]
double set_memory_limit(VolumePlan& plan, const WarpArguments& arguments);

/// Sets `memory`, `memory_limit` and, with --dry-run, `refusal` of a plan. Throws
/// std::invalid_argument, IoError if sources, outputs and extra outputs do not fit in memory; with
/// --memory if they cannot be computed in blocks.
/// @returns whether a second set of outputs also fits
bool plan_memory(VolumePlan& plan,
                 const WarpArguments& arguments,
                 const MeshReader& mesh,
                 const std::vector<std::int64_t>& steps);

/// The value of --memory that allows so much: "39M".
std::string limit_text(double bytes);

/// Host memory of the largest block of a step that is cut as finely as possible [byte].
double least_block_memory(BlockPlanner& planner,
                          const std::vector<Point3>& positions,
                          BlockLimits limits);

}  // namespace tetwarp::cli
