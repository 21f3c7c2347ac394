/// @file collide_scenes.hpp
/// Surfaces and motions for tests of collision detection.
#pragma once
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "host/base/point3.hpp"
#include "host/collide/detector.hpp"

namespace tetwarp::test {

struct BodyFlags {
  bool has_unknowns = true;
  bool touches_itself = false;
};

/// Surfaces with their motion; bodies are added one after the other.
struct CollideScene {
  CollisionSurfaces surfaces;
  SurfaceMotion motion;

  std::int32_t body_count() const { return static_cast<std::int32_t>(surfaces.bodies.size()); }

  /// Triangles without motion; edges are made of them.
  void add_mesh(const std::vector<Point3>& vertices,
                const std::vector<std::array<std::int32_t, 3>>& triangles,
                const BodyFlags& flags = {});
  void add_sphere(const Point3& center, double radius, const BodyFlags& flags = {});
  void add_capsule(const Point3& a, const Point3& b, double radius, const BodyFlags& flags = {});
  void add_plane(const PlanePlace& place);
  /// A closed surface of 2 rings * sectors triangles.
  void add_ball(
      const Point3& center, double radius, int rings, int sectors, const BodyFlags& flags = {});
  /// A flat square in z = const of 2 cells^2 triangles.
  void add_sheet(const Point3& corner, double edge, int cells, const BodyFlags& flags = {});
  /// Triangles of random places in a cube; every eighth has no area or no length.
  void add_soup(std::mt19937& random,
                const Point3& center,
                double cube,
                double triangle_size,
                int count,
                const BodyFlags& flags = {});

  /// The body's vertices end at this displacement from their start.
  void move_body(std::int32_t body, const Point3& way);
  /// All vertices of the body end at random places within `amount` of their end.
  void shake_body(std::int32_t body, double amount, std::mt19937& random);
  void move_all(const Point3& offset);  ///< start and end

 private:
  CollisionBody& begin_body(const BodyFlags& flags);
  void end_body();
  std::int32_t add_vertex(const Point3& place, double radius);
};

/// All vertices and planes of the motion end where they start.
SurfaceMotion at_rest(const SurfacePlaces& places);

/// Balls, soups, spheres, capsules, planes, a sheet that touches itself, fixed bodies, a forbidden
/// pair; all within about one meter and moving by up to `speed` [m].
CollideScene mixed_scene(unsigned seed, double speed);

/// A pile of `count` balls of about `triangles` triangles in all, which overlap their neighbors
/// slightly, in random order and rotation.
CollideScene pile_scene(int count, int triangles, const BodyFlags& flags = {});

}  // namespace tetwarp::test
