/// @file test_flat_edges.cpp
/// Edges within flat faces of rigid bodies: which edges are marked, and that distances and hits are
/// the same without them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/simulate/model/rotations.hpp"
#include "host/simulate/surfaces/flat_edges.hpp"
#include "tests/simulate/pair_scene.hpp"

namespace tetwarp::test {
namespace {

constexpr double tolerance = 1e-3 * h;

void mark_flat_edges(PairScene& scene) {
  CollisionSurfaces& all = scene.scene.surfaces;
  all.edge_is_flat.assign(all.edges.size(), 0);
  all.vertex_is_flat.assign(all.vertex_body.size(), 0);
  for (const CollisionBody& body : all.bodies) {
    const auto position =
        std::span(scene.motion.start.vertices)
            .subspan(static_cast<std::size_t>(body.first_vertex),
                     static_cast<std::size_t>(body.vertex_end - body.first_vertex));
    mark_flat_edges(all, body, position, tolerance);
  }
}

std::ptrdiff_t flat_count(const Square& mesh) {
  PairScene scene;
  scene.add_mesh(mesh.vertices, mesh.triangles, {});
  mark_flat_edges(scene);
  return std::ranges::count(scene.scene.surfaces.edge_is_flat, 1);
}

/// n cells in a row, each turned against the one before.
Square strip(int cells, double angle) {
  Square result;
  Point3 x{0, 0, 0};
  for (std::int32_t k = 0; k <= cells; ++k) {
    result.vertices.insert(result.vertices.end(), {x, plus(x, {0, 0.01, 0})});
    x = plus(x, {0.01 * std::cos(k * angle), 0, 0.01 * std::sin(k * angle)});
    const std::int32_t v = 2 * k;
    if (k < cells) {
      result.triangles.insert(result.triangles.end(), {{v, v + 2, v + 3}, {v, v + 3, v + 1}});
    }
  }
  return result;
}

TEST(FlatEdges, AreThoseWithinTheSidesOfABox) {
  EXPECT_EQ(flat_count(box({0, 0, 0}, {1, 2, 3})), 6);
  EXPECT_EQ(flat_count(fine_box({0, 0, 0}, {1, 2, 3}, 3)), 6 * (9 + 6 + 6));
}

TEST(FlatEdges, AreNoneOfFacesThatBendAsAWhole) {
  EXPECT_EQ(flat_count(strip(100, 0)), 199);
  const double angle = 0.5 * tolerance / 0.01;  // neighbors are on one plane
  EXPECT_EQ(flat_count(strip(2, angle)), 3);
  EXPECT_EQ(flat_count(strip(100, angle)), 0);
}

TEST(FlatEdges, AreNoneOfFoldedOpenAndDegenerateTriangles) {
  const std::vector<Point3> square = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 1, 0}, {1, 1, 0}};
  EXPECT_EQ(flat_count({square, {{0, 1, 2}}}), 0);
  EXPECT_EQ(flat_count({square, {{0, 1, 2}, {1, 0, 3}}}), 0);  // folded onto itself
  EXPECT_EQ(flat_count({square, {{0, 1, 2}, {1, 4, 2}}}), 1);
  EXPECT_EQ(flat_count({square, {{0, 1, 2}, {1, 4, 2}, {1, 2, 3}}}), 0);  // three at one edge
  EXPECT_EQ(flat_count({square, {{2, 3, 4}, {2, 4, 0}}}), 0);             // no area
}

/// Boxes at random places, apart, with random motions: the distance, and the first hit, without
/// pairs of flat edges are those with them.
TEST(FlatEdges, ChangeNoDistanceAndNoHit) {
  std::mt19937_64 random(12);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Point3{normal(random), normal(random), normal(random)}; };
  int hits = 0;
  for (int k = 0; k < 400; ++k) {
    PairScene scene;
    const Point3 direction = unit(draw());
    const double apart = std::pow(10.0, -3.0 * (k % 4) / 3);
    for (const double side : {0.0, 1.0}) {
      Square body = k % 2 == 0 ? box({-1, -0.7, -0.4}, {1, 0.7, 0.4})
                               : fine_box({-1, -0.7, -0.4}, {1, 0.7, 0.4}, 3);
      const Point3 axis = draw();
      const double length = std::hypot(1, norm(axis));
      const Quaternion turn{1 / length, axis[0] / length, axis[1] / length, axis[2] / length};
      for (Point3& x : body.vertices) {
        x = plus(rotate(turn, x), times(side * (2.6 + apart), direction));
      }
      const Point3 way = plus(times(-1.5 * side, direction), times(0.2 * side, draw()));
      scene.add_mesh(body.vertices, body.triangles, {.way = way});
    }
    mark_flat_edges(scene);
    const auto measure = [&](bool skips) {
      const auto detector = make_cpu_detector(scene.scene.surfaces, {.skip_flat_edges = skips});
      detector->begin_step();
      double first = 2;
      for (const TouchingPair& pair : detector->detect(scene.motion)) {
        first = std::min(first, pair.time);
      }
      const double distance = detector->closest(scene.motion.start, 10).distance;
      EXPECT_EQ(detector->counts().skipped_edges > 0, skips);
      return std::pair(distance, first);
    };
    const auto [distance, time] = measure(false);
    const auto [other_distance, other_time] = measure(true);
    EXPECT_NEAR(other_distance, distance, 1e-12) << k;
    EXPECT_NEAR(other_time, time, 0.2 * h) << k;
    hits += time <= 1;
  }
  EXPECT_GT(hits, 100);
  EXPECT_LT(hits, 390);
}

}  // namespace
}  // namespace tetwarp::test
