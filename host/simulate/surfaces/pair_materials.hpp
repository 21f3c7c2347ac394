/// @file pair_materials.hpp
/// The contact material of every pair of bodies and obstacles, made from the materials of both
/// sides.
#pragma once
#include <cstdint>

#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Fills the materials, classes and pairs of `surfaces`. The friction of a pair is the geometric
/// mean of both sides. Its adhesion is that of the side with the lower energy; a side without
/// adhesion leaves none. Entries of Scene::contact.pairs override either. Sides without `contact`
/// have that of the scene.
void add_pair_materials(const Scene& scene, SceneSurfaces& surfaces);

/// Whether contacts of this material can pull.
bool adheres(const ContactMaterial& material);

}  // namespace tetwarp
