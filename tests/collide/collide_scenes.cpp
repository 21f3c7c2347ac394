#include "tests/collide/collide_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace tetwarp::test {
namespace {
Point3 random_point(std::mt19937& random, double amount) {
  std::uniform_real_distribution<double> uniform(-amount, amount);
  return {uniform(random), uniform(random), uniform(random)};
}
}  // namespace

CollisionBody& CollideScene::begin_body(const BodyFlags& flags) {
  CollisionSurfaces& s = surfaces;
  CollisionBody& body = s.bodies.emplace_back();
  body.first_vertex = static_cast<std::int32_t>(s.vertex_body.size());
  body.first_edge = static_cast<std::int32_t>(s.edges.size());
  body.first_triangle = static_cast<std::int32_t>(s.triangles.size());
  body.first_plane = static_cast<std::int32_t>(s.plane_body.size());
  body.has_unknowns = flags.has_unknowns;
  body.touches_itself = flags.touches_itself;
  return body;
}

void CollideScene::end_body() {
  CollisionSurfaces& s = surfaces;
  CollisionBody& body = s.bodies.back();
  body.vertex_end = static_cast<std::int32_t>(s.vertex_body.size());
  body.edge_end = static_cast<std::int32_t>(s.edges.size());
  body.triangle_end = static_cast<std::int32_t>(s.triangles.size());
  body.plane_end = static_cast<std::int32_t>(s.plane_body.size());
}

std::int32_t CollideScene::add_vertex(const Point3& place, double radius) {
  surfaces.vertex_body.push_back(body_count() - 1);
  surfaces.vertex_radius.push_back(radius);
  surfaces.vertex_area.push_back(0);
  motion.start.vertices.push_back(place);
  motion.end.vertices.push_back(place);
  motion.sagitta.push_back(0);
  return static_cast<std::int32_t>(surfaces.vertex_body.size()) - 1;
}

void CollideScene::add_mesh(const std::vector<Point3>& vertices,
                            const std::vector<std::array<std::int32_t, 3>>& triangles,
                            const BodyFlags& flags) {
  const std::int32_t first = begin_body(flags).first_vertex;
  for (const Point3& place : vertices) add_vertex(place, 0);
  std::map<std::array<std::int32_t, 2>, int> edges;
  for (const auto& own : triangles) {
    const std::array<std::int32_t, 3> corner = {first + own[0], first + own[1], first + own[2]};
    surfaces.triangles.push_back(corner);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t v = corner[k], w = corner[(k + 1) % 3];
      if (edges[{std::min(v, w), std::max(v, w)}]++ > 0) continue;
      surfaces.edges.push_back({v, w});
      surfaces.edge_radius.push_back(0);
    }
  }
  end_body();
}

void CollideScene::add_sphere(const Point3& center, double radius, const BodyFlags& flags) {
  begin_body(flags);
  add_vertex(center, radius);
  end_body();
}

void CollideScene::add_capsule(const Point3& a,
                               const Point3& b,
                               double radius,
                               const BodyFlags& flags) {
  begin_body(flags);
  const std::int32_t v = add_vertex(a, radius), w = add_vertex(b, radius);
  surfaces.edges.push_back({v, w});
  surfaces.edge_radius.push_back(radius);
  end_body();
}

void CollideScene::add_plane(const PlanePlace& place) {
  begin_body({.has_unknowns = false});
  surfaces.plane_body.push_back(body_count() - 1);
  motion.start.planes.push_back(place);
  motion.end.planes.push_back(place);
  end_body();
}

void CollideScene::add_ball(
    const Point3& center, double radius, int rings, int sectors, const BodyFlags& flags) {
  std::vector<Point3> vertices = {plus(center, {0, 0, radius})};
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (int r = 1; r <= rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      const double polar = std::numbers::pi * r / (rings + 1);
      const double turn = 2 * std::numbers::pi * (s + 0.5 * r) / sectors;
      vertices.push_back(
          plus(center, {radius * std::sin(polar) * std::cos(turn),
                        radius * std::sin(polar) * std::sin(turn), radius * std::cos(polar)}));
    }
  }
  vertices.push_back(plus(center, {0, 0, -radius}));
  const auto last = static_cast<std::int32_t>(vertices.size()) - 1;
  const auto at = [&](int ring, int s) { return 1 + (ring - 1) * sectors + s % sectors; };
  for (int s = 0; s < sectors; ++s) {
    triangles.push_back({0, at(1, s), at(1, s + 1)});
    for (int r = 1; r < rings; ++r) {
      triangles.push_back({at(r, s), at(r + 1, s), at(r, s + 1)});
      triangles.push_back({at(r, s + 1), at(r + 1, s), at(r + 1, s + 1)});
    }
    triangles.push_back({at(rings, s), last, at(rings, s + 1)});
  }
  add_mesh(vertices, triangles, flags);
}

void CollideScene::add_sheet(const Point3& corner, double edge, int cells, const BodyFlags& flags) {
  std::vector<Point3> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      vertices.push_back(plus(corner, {edge * i / cells, edge * j / cells, 0}));
    }
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int v = j * (cells + 1) + i, up = v + cells + 1;
      triangles.push_back({v, v + 1, up});
      triangles.push_back({v + 1, up + 1, up});
    }
  }
  add_mesh(vertices, triangles, flags);
}

void CollideScene::add_soup(std::mt19937& random,
                            const Point3& center,
                            double cube,
                            double triangle_size,
                            int count,
                            const BodyFlags& flags) {
  std::vector<Point3> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (int t = 0; t < count; ++t) {
    const Point3 middle = plus(center, random_point(random, cube / 2));
    const Point3 a = plus(middle, random_point(random, triangle_size / 2));
    const Point3 b = plus(middle, random_point(random, triangle_size / 2));
    Point3 c = plus(middle, random_point(random, triangle_size / 2));
    if (t % 16 == 0) c = times(0.5, plus(a, b));
    vertices.insert(vertices.end(), {a, t % 16 == 8 ? a : b, t % 16 == 8 ? a : c});
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  add_mesh(vertices, triangles, flags);
}

void CollideScene::move_body(std::int32_t body, const Point3& way) {
  const CollisionBody& own = surfaces.bodies[static_cast<std::size_t>(body)];
  for (auto v = own.first_vertex; v < own.vertex_end; ++v) {
    const auto at = static_cast<std::size_t>(v);
    motion.end.vertices[at] = plus(motion.start.vertices[at], way);
  }
}

void CollideScene::shake_body(std::int32_t body, double amount, std::mt19937& random) {
  const CollisionBody& own = surfaces.bodies[static_cast<std::size_t>(body)];
  for (auto v = own.first_vertex; v < own.vertex_end; ++v) {
    Point3& end = motion.end.vertices[static_cast<std::size_t>(v)];
    end = plus(end, random_point(random, amount));
  }
}

void CollideScene::move_all(const Point3& offset) {
  for (SurfacePlaces* places : {&motion.start, &motion.end}) {
    for (Point3& place : places->vertices) place = plus(place, offset);
    for (PlanePlace& plane : places->planes) plane.point = plus(plane.point, offset);
  }
}

SurfaceMotion at_rest(const SurfacePlaces& places) {
  return {places, places, std::vector<double>(places.vertices.size())};
}

CollideScene mixed_scene(unsigned seed, double speed) {
  std::mt19937 random(seed);
  CollideScene scene;
  scene.surfaces.thickness = 2e-3;
  scene.add_plane({{0, 0, -0.45}, {0, 0, 1}});
  scene.add_plane({{-0.5, 0, 0}, {0.8, 0, 0.6}});
  const auto place = [&] { return random_point(random, 0.4); };
  for (int k = 0; k < 3; ++k) scene.add_ball(place(), 0.05 + 0.1 * k, 4, 7);
  scene.add_soup(random, {0, 0, 0}, 0.8, 0.1, 32);
  scene.add_soup(random, {0, 0, 0}, 0.8, 0.15, 24, {.touches_itself = true});
  scene.add_soup(random, {0, 0, 0}, 0.8, 0.2, 16, {.has_unknowns = false});
  scene.add_sheet({-0.5, -0.5, 0.02}, 1, 6, {.touches_itself = true});
  scene.add_sheet({-0.5, -0.5, -0.2}, 1, 1, {.has_unknowns = false});
  for (int k = 0; k < 6; ++k) scene.add_sphere(place(), 0.02 + 0.02 * k, {.has_unknowns = k != 3});
  for (int k = 0; k < 4; ++k) {
    const Point3 a = place();
    scene.add_capsule(a, plus(a, random_point(random, 0.3)), 0.03, {.has_unknowns = k != 1});
  }
  scene.surfaces.forbidden = {{2, 4}, {3, 5}, {5, 9}};
  for (std::int32_t b = 2; b < scene.body_count(); ++b) {
    scene.move_body(b, random_point(random, speed));
    scene.shake_body(b, 0.2 * speed, random);
  }
  scene.motion.end.planes[1] = {{-0.5 + 0.3 * speed, 0, 0}, {0.6, 0, 0.8}};
  return scene;
}

CollideScene pile_scene(int count, int triangles, const BodyFlags& flags) {
  CollideScene scene;
  std::mt19937 random(5);
  const double radius = 0.03;
  const int sectors = std::max(3, static_cast<int>(std::sqrt(1.1 * triangles / count)));
  const int rings = std::max(1, triangles / (2 * count * sectors));
  scene.surfaces.thickness = 1e-5;
  for (int b = 0; b < count; ++b) {
    const int layer = b / 9, row = b / 3 % 3;
    const Point3 cell = {b % 3 * 1.98, row * 1.98, layer * 1.98};
    const Point3 center = plus(times(radius, cell), random_point(random, 0.02 * radius));
    scene.add_ball(center, radius, rings, sectors, flags);
    scene.move_body(b, plus({0, 0, -1e-3}, random_point(random, 5e-4)));
  }
  return scene;
}

}  // namespace tetwarp::test
