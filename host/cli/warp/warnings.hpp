/// @file warnings.hpp
/// Warnings of a warp: inputs and results that are valid but seldom meant. One line each.
#pragma once
#include <span>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/report.hpp>

#include "host/cli/warp/warp_arguments.hpp"

namespace tetwarp::cli {

using Warnings = std::vector<std::string>;

/// A mesh without a deformation.
Warnings mesh_warnings(const MeshHeader& mesh, const WarpArguments& arguments);

/// A volume of several steps of which one is warped by all steps of the mesh; unless arrays are
/// named, what of the volume is not warped, and floats of 2 bytes.
Warnings volume_warnings(const std::string& path,
                         const VolumeHeader& volume,
                         const MeshHeader& mesh,
                         const WarpArguments& arguments);

/// Values that do not fit the type of an array: the background, densities and totals.
/// @param arrays  those that are warped
Warnings array_warnings(const std::string& volume,
                        const std::vector<ArrayHeader>& arrays,
                        const WarpArguments& arguments);

/// Results of steps: inverted cells, and meshes that cover no voxel. Steps that were not computed
/// give none.
Warnings step_warnings(const std::string& mesh, std::span<const StepReport> steps);

/// Times of the steps of a series that its format or its readers do not keep: in NIfTI those that
/// are not equally spaced, in VTKHDF those that do not increase. Empty when there are none.
std::string times_warning(const std::string& output, const std::vector<double>& times);

/// For --strict: throws std::runtime_error with the first warning, if there is one.
void refuse_warnings(const Warnings& warnings);

/// Prints each as one line to standard error. @param job  empty, or a name such as "job 3"
void print_warnings(const Warnings& warnings, const std::string& job);

}  // namespace tetwarp::cli
