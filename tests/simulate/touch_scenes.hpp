/// @file touch_scenes.hpp
/// Bodies and surfaces for tests of contact.
#pragma once
#include <cstdint>
#include <string>
#include <utility>

#include "host/simulate/surfaces/surface_motion.hpp"
#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {

inline Body rigid_ball(const std::string& name, double radius, const Point3& position) {
  Body body;
  body.name = name;
  body.kind = BodyKind::rigid;
  body.geometry = Shape{EllipsoidShape{{radius, radius, radius}}};
  body.pose.position = position;
  return body;
}

inline Body rigid_capsule(const std::string& name,
                          double radius,
                          double length,
                          const Point3& position) {
  Body body = rigid_ball(name, radius, position);
  body.geometry = Shape{CapsuleShape{radius, length}};
  return body;
}

/// An elastic ball of radius 0.1 with about 80 triangles.
inline Body soft_ball(const std::string& name, const Point3& position) {
  Body body = elastic_box(name, {0.1, 0.1, 0.1}, {3, 3, 3});
  body.geometry = Shape{EllipsoidShape{{0.1, 0.1, 0.1}}};
  body.surface = std::int64_t{80};
  body.pose.position = position;
  return body;
}

/// How all surfaces move in a step.
inline SurfaceMotion motion_of(const SurfaceStep& step, int threads = 1) {
  SurfaceMotion motion;
  surface_places(step.scene, step.model, step.state, threads, motion.start);
  frame_motion(step, motion);
  vertex_motion(step, threads, motion);
  return motion;
}

/// A scene with all that is made of it; refers to itself.
struct TouchScene {
  explicit TouchScene(Scene of)
      : scene(std::move(of)),
        geometry(make_scene_geometry(scene)),
        model(make_model(scene, geometry)),
        surfaces(make_scene_surfaces(scene, geometry, model)) {}
  TouchScene(const TouchScene&) = delete;
  TouchScene& operator=(const TouchScene&) = delete;

  const CollisionBody& body(std::size_t index) const { return surfaces.surfaces.bodies[index]; }
  const ContactMaterial& material(std::int32_t a, std::int32_t b) const {
    return at(surfaces.materials, surfaces.material_of(a, b));
  }

  Scene scene;
  SceneGeometry geometry;
  Model model;
  SceneSurfaces surfaces;
};

}  // namespace tetwarp::test
