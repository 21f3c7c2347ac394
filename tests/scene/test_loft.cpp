/// @file test_loft.cpp
/// Lofts: closed surfaces through their stations, volumes, tetrahedra around them, wrong ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <tetwarp/loft.hpp>
#include <tetwarp/surface.hpp>
#include <vector>

#include "host/scene/shapes/surface.hpp"
#include "tests/scene/surface_checks.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp {
namespace {
using scene_checks::euler_number;
using scene_checks::is_manifold;
using scene_checks::sum_of;
using scene_checks::volumes_of;
using std::numbers::pi;

/// Tubes of 2 to 6 stations that turn gently, with radii from 5 to 20 mm.
std::vector<LoftTube> random_tubes(int count) {
  std::mt19937_64 random(11);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  std::vector<LoftTube> tubes;
  for (int n = 0; n < count; ++n) {
    LoftTube tube;
    Point3 center{number(-1, 1), number(-1, 1), number(-1, 1)}, step{0.06, 0, 0};
    for (int s = 0; s < 2 + n % 5; ++s) {
      tube.stations.push_back({center, {number(0.005, 0.02), number(0.005, 0.02)}, {0, 0, 0}});
      for (double& x : step) x += number(-0.012, 0.012);
      center = plus(center, step);
    }
    tube.stations[0].direction = {number(-0.3, 0.3), 1, number(-1, 1)};
    tube.ends = {number(0.002, 0.03), number(0.002, 0.03)};
    tubes.push_back(tube);
  }
  return tubes;
}

TEST(Loft, HasAClosedSurfaceOutwardsOfAboutAsManyTrianglesAsAsked) {
  for (const LoftTube& tube : random_tubes(20)) {
    for (const std::int64_t triangles : {4, 100, 1280, 5000}) {
      const Surface surface = make_loft_surface({tube}, triangles);

      EXPECT_TRUE(is_manifold(surface));
      EXPECT_EQ(euler_number(surface), 2);
      EXPECT_NO_THROW(check_areas("loft", surface));
      EXPECT_NO_THROW(check_closed("loft", surface));
      if (triangles >= 1280) {
        EXPECT_NEAR(double(surface.triangles.size()) / double(triangles), 1, 0.2);
      }
    }
  }
}

/// A straight tube along x, whose cross-sections are known: a ring of points on each station's
/// ellipse, all others no further out than the widest of both stations beside them.
TEST(Loft, PassesThroughTheEllipseOfEachStation) {
  for (LoftTube tube : random_tubes(20)) {
    const std::size_t count = tube.stations.size();
    for (std::size_t n = 0; n < count; ++n) tube.stations[n].center = {0.06 * double(n), 1, 2};
    tube.stations[0].direction = {1, 1, 0};  // y, made perpendicular
    const Surface surface = make_loft_surface({tube}, 1280);
    for (std::size_t n = 0; n < count; ++n) {
      const LoftStation& station = tube.stations[n];
      int on_ring = 0;
      for (const Point3& x : surface.points) {
        if (std::abs(x[0] - station.center[0]) > 1e-15) continue;
        ++on_ring;
        EXPECT_NEAR(std::hypot((x[1] - 1) / station.radii[0], (x[2] - 2) / station.radii[1]), 1,
                    1e-12);
      }
      EXPECT_GE(on_ring, 8);
    }
    for (const Point3& x : surface.points) {
      const double place = std::clamp(x[0] / 0.06, 0.0, double(count - 1));
      const LoftStation& low = tube.stations[std::size_t(place)];
      const LoftStation& high = tube.stations[std::min(std::size_t(place) + 1, count - 1)];
      EXPECT_LE(std::hypot((x[1] - 1) / std::max(low.radii[0], high.radii[0]),
                           (x[2] - 2) / std::max(low.radii[1], high.radii[1])),
                1 + 1e-12);
    }
  }
}

/// Two equal stations are an elliptical cylinder between half ellipsoids.
TEST(Loft, HasTheVolumeOfACapsule) {
  for (const double end : {0.001, 0.02, 0.05}) {
    const LoftTube tube{{{{1, 2, 3}, {0.02, 0.01}, {0, 1, 0}}, {{1.1, 2, 3}, {0.02, 0.01}}},
                        {end, end}};
    EXPECT_NEAR(loft_volume(tube) / (pi * 0.02 * 0.01 * (0.1 + 4 * end / 3)), 1, 1e-12);
  }
}

/// Pappus: along any center line the volume is that of its length. The stations of a half circle
/// approach it.
TEST(Loft, OfAHalfCircleApproachesTheTorus) {
  double error[2];
  for (const int k : {0, 1}) {
    const int segments = k == 0 ? 8 : 16;
    LoftTube tube;
    for (int n = 0; n <= segments; ++n) {
      const double angle = pi * n / segments;
      tube.stations.push_back({{0.05 * std::cos(angle), 0.05 * std::sin(angle), 0}, {0.01, 0.004}});
    }
    tube.stations[0].direction = {1, 0, 0};
    tube.ends = {1e-6, 1e-6};
    const double exact = pi * 0.01 * 0.004 * (pi * 0.05 + 4e-6 / 3);
    error[k] = std::abs(loft_volume(tube) / exact - 1);
  }
  EXPECT_LT(error[0], 2e-3);
  EXPECT_LT(error[1], error[0] / 4);
}

/// The surface lies within chords of the tube: its volume approaches the integral in second order.
TEST(Loft, EnclosesItsVolumeToSecondOrder) {
  for (const LoftTube& tube : random_tubes(20)) {
    const double exact = loft_volume(tube);
    const double coarse = 1 - volume_of(make_loft_surface({tube}, 1000)) / exact;
    const double fine = 1 - volume_of(make_loft_surface({tube}, 16000)) / exact;

    EXPECT_LT(std::abs(coarse), 0.1);
    EXPECT_NEAR(coarse / fine, 16, 6);
  }
}

TEST(Loft, KeepsTheSurfaceOfEachTube) {
  const std::vector<LoftTube> tubes = random_tubes(3);
  const Surface surface = make_loft_surface(tubes, 6000);

  double volume = 0;
  for (const LoftTube& tube : tubes) volume += loft_volume(tube);
  EXPECT_TRUE(is_manifold(surface));
  EXPECT_EQ(euler_number(surface), 6);
  EXPECT_NEAR(volume_of(surface) / volume, 1, 0.02);
}

TEST(Loft, IsInsideItsTetrahedra) {
  for (const LoftTube& tube : random_tubes(20)) {
    for (const std::array<std::int64_t, 3> cells :
         {std::array<std::int64_t, 3>{20, 1, 1}, {20, 2, 2}, {20, 3, 2}, {20, 4, 4}}) {
      const Mesh mesh = make_loft_mesh(tube, {.cells = cells});

      const std::vector<double> volumes = volumes_of(mesh.rest_positions, mesh.tets);
      EXPECT_EQ(volumes.size(), std::size_t(5 * cells[0] * cells[1] * cells[2]));
      for (const double volume : volumes) EXPECT_GT(volume, 0);
      const double ratio = sum_of(volumes) / loft_volume(tube);
      EXPECT_GT(ratio, 1.05);
      EXPECT_LT(ratio, cells[1] == 1 ? 2.3 : 1.7);
      double radius = 1;
      for (const LoftStation& s : tube.stations)
        radius = std::min({radius, s.radii[0], s.radii[1]});
      const BoundPoints bound = bind_points(mesh, make_loft_surface({tube}, 1000).points);
      EXPECT_LT(bound.largest_distance, 0.05 * radius);
    }
  }
}

TEST(Loft, HasAboutTheNumberOfTetrahedraAsked) {
  for (const LoftTube& tube : random_tubes(5)) {
    const Mesh mesh = make_loft_mesh(tube, {.tets = 500});
    EXPECT_NEAR(double(mesh.tets.size()) / 500, 1, 0.15);
  }
}

TEST(Loft, RefusesWhatIsNoTube) {
  LoftTube tube{{{{0, 0, 0}, {0.1, 0.1}, {0, 1, 0}}, {{1, 0, 0}, {0.1, 0.1}}}, {0.1, 0.1}};
  const auto message = [&](const LoftTube& of) {
    return test::message_of([&] { static_cast<void>(loft_volume(of)); });
  };
  EXPECT_EQ(message({{tube.stations[0]}, {1, 1}}), "stations: expected two or more");
  LoftTube wrong = tube;
  wrong.stations[1].radii[1] = 0;
  EXPECT_TRUE(message(wrong).starts_with("stations[1].radii: is 0"));
  wrong = tube;
  wrong.stations[1].center = {0, 0, 0};
  EXPECT_EQ(message(wrong), "stations[1].center: is that of the station before, move it");
  wrong = tube;
  wrong.stations[0].direction = {2, 0, 0};
  EXPECT_EQ(message(wrong),
            "stations[0].direction: is along the center line or opposite to the next one, turn it");
  wrong = tube;
  wrong.ends[0] = -1;
  EXPECT_TRUE(message(wrong).starts_with("ends: is -1"));
  wrong = tube;
  wrong.stations[1].center = {0.05, 0.05, 0};
  wrong.stations.push_back({{0, 0.1, 0}, {0.1, 0.1}});
  EXPECT_NE(message(wrong).find("bends so much that cross-sections meet"), std::string::npos);
  wrong = tube;
  wrong.stations[1].center = {1e300, 0, 0};
  EXPECT_TRUE(message(wrong).starts_with("stations: are 1e+300 m long and at most 0.1 m wide"));
  EXPECT_EQ(test::message_of([&] { make_loft_mesh(tube, {}); }),
            "lattice: expected exactly one of cells, edge and tets");
  EXPECT_TRUE(test::message_of([&] { make_loft_surface({tube}, 3); }).starts_with("triangles"));
  EXPECT_EQ(test::message_of([] { make_loft_surface({}); }), "tubes: expected one or more");
}
}  // namespace
}  // namespace tetwarp
