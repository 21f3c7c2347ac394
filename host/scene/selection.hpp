/// @file selection.hpp
/// The points of a body that a selection selects.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/body_geometry.hpp"

namespace tetwarp {

/// Which points of a body a selection selects from.
enum class Selectable {
  nodes,          ///< of a rigid body: points of its surface
  surface_points  ///< of cloth its nodes
};

/// Sorted, each point once.
/// @param place  of the selection, for messages
/// @throws std::invalid_argument  nothing is selected, nodes do not exist, a label of a body
/// without
///         tetrahedra in an image
std::vector<std::int32_t> select(const std::string& place,
                                 const Selection& selection,
                                 const Body& body,
                                 const BodyParts& parts,
                                 Selectable from);

}  // namespace tetwarp
