#include "tests/simulate/pair_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace tetwarp::test {

PairScene::PairScene() {
  scene.surfaces.thickness = h;
  scene.materials = {{}};
  scene.class_count = 1;
  scene.class_material = {0};
}

PairScene::Kind still() {
  return {.has_unknowns = false};
}

CollisionBody& PairScene::begin(const Kind& kind) {
  CollisionSurfaces& all = scene.surfaces;
  CollisionBody body;
  body.first_vertex = body.vertex_end = static_cast<std::int32_t>(all.vertex_body.size());
  body.first_edge = body.edge_end = static_cast<std::int32_t>(all.edges.size());
  body.first_triangle = body.triangle_end = static_cast<std::int32_t>(all.triangles.size());
  body.first_plane = body.plane_end = static_cast<std::int32_t>(all.plane_body.size());
  body.has_unknowns = kind.has_unknowns;
  body.touches_itself = kind.touches_itself;
  body.is_rigid = kind.is_rigid;
  all.bodies.push_back(body);
  scene.body_rigid.push_back(kind.is_rigid ? 0 : -1);
  scene.contact_class.push_back(0);
  scene.body_size.push_back(1);
  return all.bodies.back();
}

void PairScene::add_vertex(const Point3& x, double radius, const Kind& kind) {
  CollisionSurfaces& all = scene.surfaces;
  all.vertex_body.push_back(static_cast<std::int32_t>(all.bodies.size()) - 1);
  all.vertex_radius.push_back(radius);
  all.vertex_area.push_back(0);
  motion.start.vertices.push_back(x);
  motion.end.vertices.push_back(plus(x, kind.way));
  motion.sagitta.push_back(0);
}

void PairScene::end() {
  CollisionSurfaces& all = scene.surfaces;
  CollisionBody& body = all.bodies.back();
  body.vertex_end = static_cast<std::int32_t>(all.vertex_body.size());
  body.edge_end = static_cast<std::int32_t>(all.edges.size());
  body.triangle_end = static_cast<std::int32_t>(all.triangles.size());
  body.plane_end = static_cast<std::int32_t>(all.plane_body.size());
}

std::int32_t PairScene::add_mesh(const std::vector<Point3>& vertices,
                                 const std::vector<std::array<std::int32_t, 3>>& triangles,
                                 const Kind& kind) {
  const std::int32_t first = begin(kind).first_vertex;
  CollisionSurfaces& all = scene.surfaces;
  for (const Point3& x : vertices) add_vertex(x, 0, kind);
  std::map<std::array<std::int32_t, 2>, int> edges;
  for (const auto& [a, b, c] : triangles) {
    all.triangles.push_back({first + a, first + b, first + c});
    const double area = norm(cross(minus(at(vertices, b), at(vertices, a)),
                                   minus(at(vertices, c), at(vertices, a)))) /
                        2;
    for (const std::int32_t v : {a, b, c})
      all.vertex_area[static_cast<std::size_t>(first + v)] += area / 3;
    for (const auto& [v, w] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      ++edges[{first + std::min(v, w), first + std::max(v, w)}];
    }
  }
  for (const auto& [edge, count] : edges) {
    all.edges.push_back(edge);
    all.edge_radius.push_back(0);
  }
  end();
  return scene.body_count() - 1;
}

std::int32_t PairScene::add_sphere(const Point3& center, double radius, const Kind& kind) {
  begin(kind);
  add_vertex(center, radius, kind);
  end();
  return scene.body_count() - 1;
}

std::int32_t PairScene::add_capsule(const Point3& p,
                                    const Point3& q,
                                    double radius,
                                    const Kind& kind) {
  const std::int32_t first = begin(kind).first_vertex;
  add_vertex(p, radius, kind);
  add_vertex(q, radius, kind);
  scene.surfaces.edges.push_back({first, first + 1});
  scene.surfaces.edge_radius.push_back(radius);
  end();
  return scene.body_count() - 1;
}

std::int32_t PairScene::add_plane(const Point3& point, const Point3& normal) {
  begin(still());
  scene.surfaces.plane_body.push_back(scene.body_count() - 1);
  motion.start.planes.push_back({point, normal});
  motion.end.planes.push_back({point, normal});
  end();
  return scene.body_count() - 1;
}

std::vector<TouchingPair> PairScene::pairs() const {
  const auto detector = make_cpu_detector(scene.surfaces, {});
  detector->begin_step();
  return detector->detect(motion);
}

const std::vector<ReportedContact>& PairScene::contacts(std::span<const ContactRecord> records) {
  const auto detector = make_cpu_detector(scene.surfaces, {});
  detector->begin_step();
  detector->find_touches(motion);
  maker_ = std::make_unique<PairContacts>(scene);
  return maker_->find(detector->touches(), motion.start.vertices, records);
}

std::vector<BodyPlace> PairScene::places() const {
  std::vector<BodyPlace> places(scene.surfaces.bodies.size());
  for (std::size_t b = 0; b < places.size(); ++b) {
    const CollisionBody& body = scene.surfaces.bodies[b];
    if (body.is_rigid) continue;
    places[b].vertices =
        std::span(motion.start.vertices)
            .subspan(static_cast<std::size_t>(body.first_vertex),
                     static_cast<std::size_t>(body.vertex_end - body.first_vertex));
  }
  return places;
}

Square square(std::int32_t cells, double z, bool faces_up, double size) {
  Square result;
  for (std::int32_t j = 0; j <= cells; ++j) {
    for (std::int32_t i = 0; i <= cells; ++i) {
      result.vertices.push_back({size * i / cells, size * j / cells, z});
    }
  }
  const std::int32_t row = cells + 1;
  for (std::int32_t j = 0; j < cells; ++j) {
    for (std::int32_t i = 0; i < cells; ++i) {
      const std::int32_t v = j * row + i;
      result.triangles.push_back({v, v + 1, v + row + 1});
      result.triangles.push_back({v, v + row + 1, v + row});
    }
  }
  if (!faces_up) {
    for (auto& triangle : result.triangles) std::swap(triangle[1], triangle[2]);
  }
  return result;
}

Square fine_box(const Point3& low, const Point3& high, std::int32_t cells) {
  Square result;
  std::map<std::array<std::int32_t, 3>, std::int32_t> number;
  const auto vertex = [&](const std::array<std::int32_t, 3>& ijk) {
    const auto [found, is_new] =
        number.try_emplace(ijk, static_cast<std::int32_t>(result.vertices.size()));
    if (is_new) {
      Point3 x;
      for (std::size_t d = 0; d < 3; ++d) x[d] = low[d] + (high[d] - low[d]) * ijk[d] / cells;
      result.vertices.push_back(x);
    }
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, w = (axis + 2) % 3;
    for (const std::int32_t side : {0, cells}) {
      for (std::int32_t j = 0; j < cells; ++j) {
        for (std::int32_t i = 0; i < cells; ++i) {
          std::int32_t corner[4];
          for (std::int32_t k = 0; k < 4; ++k) {
            std::array<std::int32_t, 3> ijk{};
            ijk[axis] = side;
            ijk[u] = i + (k == 1 || k == 2);
            ijk[w] = j + (k >= 2);
            corner[k] = vertex(ijk);
          }
          if (side == 0) std::swap(corner[1], corner[3]);
          result.triangles.push_back({corner[0], corner[1], corner[2]});
          result.triangles.push_back({corner[0], corner[2], corner[3]});
        }
      }
    }
  }
  return result;
}

Square box(const Point3& low, const Point3& high) {
  return fine_box(low, high, 1);
}

double area_of(const std::vector<ReportedContact>& contacts) {
  double sum = 0;
  for (const ReportedContact& contact : contacts) sum += contact.area;
  return sum;
}

void expect_near(const Point3& a, const Point3& b, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

}  // namespace tetwarp::test
