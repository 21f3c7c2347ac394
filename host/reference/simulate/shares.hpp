/// @file shares.hpp
/// Selected points, their shares, and the points of surfaces of the reference.
#pragma once
#include <vector>

#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {

/// The point of a body's list of points that selections count: a node, or of a rigid body a point
/// of its surface.
MaterialPoint selected_point(const System& system, int body, int index);

/// Its lumped volume or area.
std::vector<double> shares_of(const System& system, int body, const std::vector<int>& selected);

/// The points of the surfaces of all bodies: of elastic ones sums of nodes.
void bind_surfaces(System& system);

}  // namespace tetwarp::reference
