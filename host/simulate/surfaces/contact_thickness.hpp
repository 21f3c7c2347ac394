/// @file contact_thickness.hpp
/// The distance at which surfaces of a scene touch.
#pragma once
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// The scene's thickness. If it has none: a thousandth of the median length of the edges of all
/// triangles at the start, of shapes with whole faces those of divided ones; without triangles, of
/// the smallest radius; without either nothing can touch, 1e-3 [m].
/// @param surfaces  with all parts of all bodies
/// @throws std::invalid_argument  the thickness is less than 1e-10 of the largest edge or radius of
///         a body, or less than 1e-12 of its largest coordinate: distances could not be resolved
double contact_thickness(const Scene& scene,
                         const SceneGeometry& geometry,
                         const Model& model,
                         const SceneSurfaces& surfaces);

}  // namespace tetwarp
