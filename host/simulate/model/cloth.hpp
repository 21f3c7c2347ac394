/// @file cloth.hpp
/// Adds cloth to a model: sheets of squares and triangle meshes.
#pragma once
#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Springs, bending and lumped masses of a cloth.
void add_cloth(const BodyPart& part, Model& model);

}  // namespace tetwarp
