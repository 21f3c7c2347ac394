/// @file curve_checks.hpp
/// Which warps there are by meshes with tetrahedra of ten nodes.
#pragma once
#include <string>

#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Why a warp does not use the curved maps of cells; empty: it does.
/// @param forward  whether the forward displacement is wanted
std::string curves_refusal(const WarpOptions& options, bool forward);

}  // namespace tetwarp
