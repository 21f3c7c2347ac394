/// @file pair_scene.hpp
/// Surfaces by hand, their motion and the contacts that detection finds.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/base/point3.hpp"
#include "host/simulate/patches/pair_contacts.hpp"

namespace tetwarp::test {

constexpr double h = 1e-3;  ///< thickness of these scenes [m]

struct PairScene {
  PairScene();

  /// What a body is, and how it moves.
  struct Kind {
    bool is_rigid = true;
    bool has_unknowns = true;
    Point3 way{0, 0, 0};  ///< of all its vertices, from start to end
    bool touches_itself = false;
  };
  /// @returns the body's index
  std::int32_t add_mesh(const std::vector<Point3>& vertices,
                        const std::vector<std::array<std::int32_t, 3>>& triangles,
                        const Kind& kind);
  std::int32_t add_sphere(const Point3& center, double radius, const Kind& kind);
  std::int32_t add_capsule(const Point3& p, const Point3& q, double radius, const Kind& kind);
  std::int32_t add_plane(const Point3& point, const Point3& normal);

  const std::vector<ReportedContact>& contacts(std::span<const ContactRecord> records = {});
  /// Detects and makes contacts of the motion.
  std::vector<TouchingPair> pairs() const;
  /// Where bodies are at the start; rigid ones without rotation.
  std::vector<BodyPlace> places() const;

  SceneSurfaces scene;
  SurfaceMotion motion;

 private:
  CollisionBody& begin(const Kind& kind);
  void add_vertex(const Point3& x, double radius, const Kind& kind);
  void end();

  std::unique_ptr<PairContacts> maker_;
};

/// The unit square at height z in n x n cells of two triangles, facing up or down.
PairScene::Kind still();
struct Square {
  std::vector<Point3> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
};
Square square(std::int32_t cells, double z, bool faces_up, double size = 1);
/// A closed box of 12 triangles.
Square box(const Point3& low, const Point3& high);
/// A closed box whose six sides are squares of n x n cells.
Square fine_box(const Point3& low, const Point3& high, std::int32_t cells);

double area_of(const std::vector<ReportedContact>& contacts);

void expect_near(const Point3& a, const Point3& b, double tolerance);

}  // namespace tetwarp::test
