/// @file ten_nodes_option.hpp
/// The option --ten-nodes: what tetrahedra of ten nodes are mapped by.
#pragma once
#include "host/cli/common/declare.hpp"

namespace tetwarp::cli {

/// Declares --ten-nodes curved|split, which sets MeshImportOptions::keeps_curved: at first true.
inline void add_ten_nodes(CLI::App& app, bool& keeps_curved) {
  keeps_curved = true;
  add_choice(app, "--ten-nodes", keeps_curved, Choices<bool>{{"curved", true}, {"split", false}},
             "tetrahedra of ten nodes: mapped through their nodes on edges, or cut into eight "
             "straight ones between their nodes [curved]");
}

}  // namespace tetwarp::cli
