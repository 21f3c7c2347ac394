/// @file triangle_cloth.hpp
/// Springs and bending of cloth that is a triangle mesh.
#pragma once
#include <vector>

#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/scalar_entries.hpp"

namespace tetwarp {

/// Springs and bending of any triangle mesh.
void add_triangle_cloth(const BodyPart& part, Model& model, std::vector<ScalarEntry>& entries);

}  // namespace tetwarp
