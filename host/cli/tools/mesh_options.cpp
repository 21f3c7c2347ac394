/// @file mesh_options.cpp
/// The options, with their help.
#include "host/cli/tools/mesh_options.hpp"

namespace tetwarp::cli {

void add_mesh_to_mesh(CLI::App& app, std::string& input, std::string& output) {
  app.add_option("MESH", input, "mesh: VTKHDF, .msh, .vtu or .vtk")->required()->type_name("");
  app.add_option("-o,--output", output, "mesh to write, with array displacement")
      ->required()
      ->type_name("MESH");
}

void add_mesh_axes(CLI::App& app, std::optional<Axes>& target) {
  add_axes(app, target, "axes of a mesh in .msh, .vtu or .vtk; lps is turned to ras [as they are]");
}

}  // namespace tetwarp::cli
