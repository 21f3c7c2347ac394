/// @file displacement.hpp
/// Meshes with a procedural displacement, for deform and demo.
#pragma once
#include <string>

#include <tetwarp/make.hpp>

namespace tetwarp::cli {

/// Writes the mesh with `step_count` steps of displacement at times 0 (rest) to 1 (the full
/// amount); a single step is at time 1.
void write_deformed_mesh(const std::string& path,
                         const Mesh& mesh,
                         const DeformOptions& options,
                         int step_count);

}  // namespace tetwarp::cli
