/// @file pair_materials.hpp
/// The contact material of every pair of bodies and obstacles, from those of the two.
#pragma once
#include <cstdint>

#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Fills the materials, classes and pairs of `surfaces`. Friction of a pair is the geometric mean
/// of both sides, adhesion that of the side with the lower energy, none where a side has none;
/// entries of Scene::contact.pairs override either. Sides without `contact` have the scene's.
void add_pair_materials(const Scene& scene, SceneSurfaces& surfaces);

/// Whether contacts of this material can hold two surfaces together.
bool adheres(const ContactMaterial& material);

}  // namespace tetwarp
