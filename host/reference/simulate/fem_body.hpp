/// @file fem_body.hpp
/// Elements and mass of an elastic body of a shape, a mesh or an image.
#pragma once
#include <vector>

#include "host/reference/simulate/elements.hpp"
#include "host/scene/scene_geometry.hpp"

namespace tetwarp::reference {

struct FemBody {
  std::vector<Element> elements;  ///< nodes counted within the body
  MatrixXd mass;                  ///< m_ab, [nodes][nodes] [kg]
};

/// Consistent masses m_ab: rho V (1 + delta_ab)/20 of an element scaled by its fraction inside a
/// shape, or the sum of rho N_a N_b over the voxels that it owns or shares. lambda and mu are the
/// means over an element's voxels times the part of its volume that they cover, at least 0.02.
FemBody fem_body(const Body& body, const BodyGeometry& geometry);

}  // namespace tetwarp::reference
