/// @file displacement.hpp
/// Meshes with a procedural displacement, for deform and demo.
#pragma once
#include <string>

#include <tetwarp/make.hpp>

namespace tetwarp::cli {

/// Writes the mesh with `step_count` steps of displacement at the times s / (step_count - 1), so
/// that the first step is rest and the last one the full amount; a single step is at time 1.
void write_deformed_mesh(const std::string& path,
                         const Mesh& mesh,
                         const DeformOptions& options,
                         int step_count);

}  // namespace tetwarp::cli
