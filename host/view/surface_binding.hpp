/// @file surface_binding.hpp
/// How the surface of a body of tetrahedra follows its nodes.
#pragma once
#include <tetwarp/simulate.hpp>
#include <tetwarp/surface.hpp>

namespace tetwarp::view {

/// Each point of BodyMesh::surface as a weighted mean of four nodes. @pre the mesh has tetrahedra
BoundPoints surface_binding(const BodyMesh& mesh);

}  // namespace tetwarp::view
