/// @file mesh_options.hpp
/// Options of the subcommands that read a mesh and write one.
#pragma once
#include <optional>
#include <string>

#include "host/cli/common/axes_option.hpp"

namespace tetwarp::cli {

/// Declares MESH and -o MESH.
void add_mesh_to_mesh(CLI::App& app, std::string& input, std::string& output);

/// Declares --axes of the mesh that is read; see axes_of_mesh().
void add_mesh_axes(CLI::App& app, std::optional<Axes>& target);

}  // namespace tetwarp::cli
