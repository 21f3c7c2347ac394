/// @file curved_arrays.hpp
/// Meshes with tetrahedra of ten nodes from arrays of Python.
#pragma once
#include <cstddef>
#include <cstring>
#include <tetwarp/curved_mesh.hpp>
#include <vector>

#include "python/arrays.hpp"

namespace tetwarp::python {

using InMidNodes = In<std::int32_t, nb::shape<-1, 6>>;  ///< as many rows as tetrahedra, or none

inline std::vector<MidNodes> mid_nodes_of(const InMidNodes& rows) {
  std::vector<MidNodes> nodes(rows.shape(0));
  if (!nodes.empty()) std::memcpy(nodes.data(), rows.data(), rows.nbytes());
  return nodes;
}

inline CurvedMesh curved_mesh_of(const InPoints& points,
                                 const InTets& tets,
                                 const InHexes& hexes,
                                 const InMidNodes& mids) {
  return {mesh_of(points, tets, hexes), mid_nodes_of(mids)};
}

}  // namespace tetwarp::python
