/// @file fem.hpp
/// Adds elastic bodies to a model.
#pragma once
#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/image_materials.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Elements, masses and mass-proportional entries of an elastic body.
/// @param images  of the bodies of the model
/// @throws std::invalid_argument  naming the body: flat or inverted tetrahedra, no mass
void add_fem(const BodyPart& part, ImageMaterialsOfBodies& images, Model& model);

}  // namespace tetwarp
