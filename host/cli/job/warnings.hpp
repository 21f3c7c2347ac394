/// @file warnings.hpp
/// Warnings of a warp: inputs and results that are valid but rarely intended. One line each.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/report.hpp>

#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

using Warnings = std::vector<std::string>;

inline void append(Warnings& all, const Warnings& more) {
  all.insert(all.end(), more.begin(), more.end());
}

/// Cells of a mesh that were merged, and a mesh without a deformation.
Warnings mesh_warnings(const std::string& path,
                       const MeshHeader& mesh,
                       const MeshReadOptions& options);

/// A volume of several steps of which one is warped by all steps of the mesh, or some have no pair.
/// Unless --array names arrays: those that are not read, and those of float16, which become
/// float32.
Warnings volume_warnings(const std::string& path,
                         const VolumeHeader& volume,
                         const MeshHeader& mesh,
                         const WarpArguments& arguments);

/// What is left out of a volume by design, which is no warning: what its header holds beyond what
/// volumes keep, and results of an earlier warp that --array does not name.
Warnings volume_notes(const std::string& path,
                      const VolumeHeader& volume,
                      const WarpArguments& arguments);

/// Labels that are stored as floats and written as integers.
/// @param stored  the same file, read without VolumeReadOptions::are_labels
/// @param arrays  those that are warped
Warnings label_notes(const std::string& path,
                     const VolumeHeader& stored,
                     const std::vector<ArrayHeader>& arrays);

/// A displacement field of a single slice, of which NIfTI files hold two components.
/// @param grid    of the output
/// @param arrays  that are written
Warnings slice_notes(const std::string& output,
                     const Grid& grid,
                     const std::vector<ArrayHeader>& arrays);

/// A background that the type of an array cannot hold; densities and totals that its integers
/// round.
/// @param arrays  those that are warped
Warnings array_warnings(const std::string& volume,
                        const std::vector<ArrayHeader>& arrays,
                        const WarpArguments& arguments);

/// Results of steps: inverted cells, and meshes that cover no voxel. Steps that were not computed
/// have no warnings.
/// @param mesh_steps  of the mesh; a single one has the number 0 whatever it warps
Warnings step_warnings(const std::string& mesh,
                       std::int64_t mesh_steps,
                       std::span<const StepReport> steps);

/// For --strict: throws std::runtime_error with the first warning, if there is one.
void refuse_warnings(const Warnings& warnings);

/// Prints each as one line to standard error. @param job  empty, or a name such as "job 3"
void print_warnings(const Warnings& warnings, const std::string& job);

/// Prints facts about a file on standard error, one line each.
/// @param path  that they are about, or the name of a job; empty: they name it
void print_notes(const std::string& path, const std::vector<std::string>& notes);

/// Prints mesh_warnings().
void print_mesh_warnings(const std::string& path,
                         const MeshHeader& mesh,
                         const MeshReadOptions& options);

/// Prints the warning about cells of a mesh that were merged, and what of a file was left out, if
/// there is any.
void print_merged(const std::string& path, const std::string& merged);
void print_left_out(const std::string& path, const std::vector<std::string>& left_out);

}  // namespace tetwarp::cli
