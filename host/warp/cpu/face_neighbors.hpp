/// @file face_neighbors.hpp
/// Which tetrahedra share a face.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/base/view.hpp"

namespace tetwarp {

/// The tetrahedra on the other sides of faces.
/// @param tets          node indices, shape [4 * tet_count]
/// @param rest_volumes  signed, per tetrahedron; 0: it is flat
/// @returns per tetrahedron and face, which is opposite the node of its number: the other
///          tetrahedron with these three nodes; -1 where there is none, or several, where one is
///          flat at rest, or where both are on the same side of the face at rest
std::vector<std::int32_t> face_neighbors(View<const std::int32_t> tets,
                                         std::span<const double> rest_volumes);

}  // namespace tetwarp
