/// @file scene_surfaces.hpp
/// The surfaces of a scene's bodies and obstacles for contact: what their vertices move with, and
/// the contact material of each pair of bodies.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/collide/collision_surfaces.hpp"
#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// The contact material of a pair of bodies for which the scene gives its own.
struct PairMaterial {
  std::array<std::int32_t, 2> bodies{0, 0};  ///< first <= second
  std::int32_t material = 0;                 ///< in SceneSurfaces::materials
};

struct SceneSurfaces {
  CollisionSurfaces surfaces;
  std::vector<ModelPoint> vertex_point;     ///< [vertices] what each vertex moves with
  std::vector<std::int32_t> surface_point;  ///< [vertices] its number among the points of the
                                            ///< body's surface, ascending; -1: of a round body
  std::vector<std::int32_t> plane_rigid;    ///< [planes] the frame that moves it
  std::vector<PlanePlace> plane_local;      ///< [planes] in that frame
  std::vector<double> body_size;            ///< [bodies, then obstacles] diagonal of the box at the
                                            ///< start [m]; infinite of planes, 0 without parts
  std::vector<std::int32_t> body_rigid;     ///< [bodies, then obstacles] the frame of a rigid one,
                                            ///< as ModelPoint::rigid, or -1: deformable
  std::vector<ContactMaterial> materials;   ///< without repetitions
  std::vector<std::int32_t> contact_class;  ///< [bodies, then obstacles] equal for equal material
  std::int32_t class_count = 0;
  std::vector<std::int32_t> class_material;  ///< [classes][classes] material of a pair of classes
  std::vector<PairMaterial> pair_materials;  ///< sorted by bodies

  std::int32_t body_count() const { return static_cast<std::int32_t>(surfaces.bodies.size()); }
  /// Material of two bodies or obstacles, in either order.
  std::int32_t material_of(std::int32_t a, std::int32_t b) const;
};

/// @pre check_scene() has passed
/// @throws std::invalid_argument  in one line naming the body: too many triangles, a thickness that
///         positions of this size cannot resolve
SceneSurfaces make_scene_surfaces(const Scene& scene,
                                  const SceneGeometry& geometry,
                                  const Model& model);

}  // namespace tetwarp
