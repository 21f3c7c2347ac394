/// @file test_rigid_patches.cpp
/// Patches of rigid bodies: few contacts with the area, moments and corners of the many.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "host/simulate/model/rotations.hpp"
#include "host/simulate/patches/patch_supports.hpp"
#include "tests/simulate/pair_scene.hpp"

namespace tetwarp::test {
namespace {
void adhere(PairScene& scene) {
  scene.scene.materials[0] = {.stiffness = 1e6, .initial_intensity = 1};
}

std::vector<ReportedContact> with_area(const std::vector<ReportedContact>& contacts) {
  std::vector<ReportedContact> result;
  for (const ReportedContact& contact : contacts) {
    if (contact.area > 0) result.push_back(contact);
  }
  return result;
}

/// Integrals over a patch of 1, x, y, xx, xy, yy, g, x g, y g.
std::array<double, 9> sums_of(const std::vector<ReportedContact>& contacts) {
  std::array<double, 9> sum{};
  for (const ReportedContact& c : contacts) {
    const double x = c.point_a_world[0], y = c.point_a_world[1], g = gap_of(c);
    const double term[9] = {1, x, y, x * x, x * y, y * y, g, x * g, y * g};
    for (std::size_t k = 0; k < 9; ++k) sum[k] += c.area * term[k];
  }
  return sum;
}

/// Contacts along two parallel lines, in any direction and order: rounding hides none of the four
/// ends.
TEST(RigidPatches, SupportsOfTwoParallelLinesAreTheirEnds) {
  for (int turn = 0; turn < 24; ++turn) {
    const double angle = 0.2617993877991494 * turn, c = std::cos(angle), s = std::sin(angle);
    std::vector<ReportedContact> contacts;
    std::vector<std::size_t> patch;
    for (int k = 0; k < 40; ++k) {
      const double x = k % 2 == 0 ? -0.06 : 0.08, y = -0.04 + 0.08 * ((k / 2 * 7) % 20) / 19;
      ReportedContact& contact = contacts.emplace_back();
      contact.point_a_world = contact.point_b_world = {c * x - s * y, s * x + c * y, 0};
      patch.push_back(static_cast<std::size_t>(k));
    }
    PatchSupports supports;
    std::vector<std::size_t> chosen;
    supports.choose(contacts, patch, h, chosen);
    std::set<std::pair<double, double>> ends;
    for (const std::size_t k : chosen) {
      const Point3& at = contacts[k].point_a_world;
      ends.emplace(std::round(1e6 * (c * at[0] + s * at[1])),
                   std::round(1e6 * (c * at[1] - s * at[0])));
    }
    EXPECT_EQ(ends, (std::set<std::pair<double, double>>{
                        {-6e4, -4e4}, {-6e4, 4e4}, {8e4, -4e4}, {8e4, 4e4}}))
        << turn;
  }
}

/// A box over a plane, tilted a little, in n x n cells: the gap is that of a plane.
TEST(RigidPatches, AdhesionPointsHaveTheMomentsOfThePatch) {
  const double wide = 0.8, deep = 0.3, z = 1.2 * h, slope_x = 3e-4, slope_y = -2e-4;
  for (const std::int32_t cells : {1, 2, 5, 12}) {
    PairScene scene;
    adhere(scene);
    Square body = fine_box({0, 0, z}, {wide, deep, 0.5}, cells);
    for (Point3& x : body.vertices) x[2] += slope_x * x[0] + slope_y * x[1];
    scene.add_mesh(body.vertices, body.triangles, {});
    scene.add_plane({0, 0, 0}, {0, 0, 1});

    const std::vector<ReportedContact> contacts = scene.contacts();
    const std::vector<ReportedContact> points = with_area(contacts);

    ASSERT_EQ(points.size(), 4U);
    EXPECT_EQ(contacts.size(), 8U);  // and four corners
    const std::array<double, 9> sum = sums_of(points);
    const double s = wide * deep, cx = wide / 2, cy = deep / 2;
    const double xx = s * wide * wide / 3, xy = s * cx * cy, yy = s * deep * deep / 3;
    const double g = z - h;
    const double exact[9] = {s,
                             s * cx,
                             s * cy,
                             xx,
                             xy,
                             yy,
                             s * g + slope_x * s * cx + slope_y * s * cy,
                             s * cx * g + slope_x * xx + slope_y * xy,
                             s * cy * g + slope_x * xy + slope_y * yy};
    for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(sum[k], exact[k], 1e-14) << cells << " " << k;
    for (const ReportedContact& point : points) {
      EXPECT_GT(point.point_a_world[0], 0);
      EXPECT_LT(point.point_a_world[0], wide);
    }
  }
}

TEST(RigidPatches, SupportsAreTheCornersSoThatTippingIsExact) {
  PairScene scene;
  const Square body = fine_box({0, 0, 1.2 * h}, {1, 0.4, 0.5}, 9);
  const Square ground = fine_box({-1, -1, -1}, {2, 2, 0}, 13);
  scene.add_mesh(body.vertices, body.triangles, {});
  scene.add_mesh(ground.vertices, ground.triangles, still());

  const std::vector<ReportedContact> contacts = scene.contacts();

  EXPECT_LE(contacts.size(), 8U);
  std::set<std::pair<long, long>> corners;
  for (const ReportedContact& contact : contacts) {
    EXPECT_EQ(contact.area, 0);
    corners.insert(
        {std::lround(1e6 * contact.point_a_world[0]), std::lround(1e6 * contact.point_a_world[1])});
  }
  for (const auto& corner :
       {std::pair{0L, 0L}, {1000000L, 0L}, {0L, 400000L}, {1000000L, 400000L}}) {
    EXPECT_EQ(corners.count(corner), 1U) << corner.first << " " << corner.second;
  }
}

/// Two crossed bars touch with edges and inner vertices: the corners of the overlap.
TEST(RigidPatches, CrossedBarsAreSupportedAtTheCornersOfTheOverlap) {
  PairScene scene;
  const Square below = fine_box({-2, -0.5, -1}, {2, 0.5, 0}, 6);
  const Square above = fine_box({-0.35, -2, 1.2 * h}, {0.35, 2, 1}, 6);
  scene.add_mesh(below.vertices, below.triangles, {});
  scene.add_mesh(above.vertices, above.triangles, {});

  const std::vector<ReportedContact> contacts = scene.contacts();

  EXPECT_LE(contacts.size(), 8U);
  for (const double x : {-0.35, 0.35}) {
    for (const double y : {-0.5, 0.5}) {
      EXPECT_TRUE(std::any_of(contacts.begin(), contacts.end(),
                              [&](const ReportedContact& c) {
                                return std::hypot(c.point_a_world[0] - x, c.point_a_world[1] - y) <
                                       1e-12;
                              }))
          << x << " " << y;
    }
  }
}

/// A disc of 64 corners keeps eight; the nearest point of a disc that is tilted is one of them.
TEST(RigidPatches, TheNearestPointStays) {
  PairScene scene;
  std::vector<Point3> vertices = {{0, 0, 1.5 * h}, {0, 0, 1}};
  std::vector<std::array<std::int32_t, 3>> triangles;
  const std::int32_t n = 64;
  for (std::int32_t k = 0; k < n; ++k) {
    const double angle = 2 * std::acos(-1) * (k + 0.3) / n;
    vertices.push_back({std::cos(angle), std::sin(angle), 1.5 * h + 3e-4 * std::cos(angle - 0.1)});
    triangles.push_back({0, 2 + (k + 1) % n, 2 + k});
    triangles.push_back({1, 2 + k, 2 + (k + 1) % n});
  }
  scene.add_mesh(vertices, triangles, {});
  scene.add_plane({0, 0, 0}, {0, 0, 1});

  const std::vector<ReportedContact> contacts = scene.contacts();

  EXPECT_EQ(contacts.size(), 8U);
  double least = 1;
  for (const Point3& x : vertices) least = std::min(least, x[2] - h);
  double nearest = 1;
  for (const ReportedContact& contact : contacts) nearest = std::min(nearest, gap_of(contact));
  EXPECT_LE(nearest - least, 0.01 * h);
}

/// Deformable bodies are never reduced.
TEST(RigidPatches, LeavesDeformableBodiesAsTheyAre) {
  PairScene scene;
  adhere(scene);
  const Square body = fine_box({0, 0, 1.2 * h}, {1, 0.4, 0.5}, 9);
  scene.add_mesh(body.vertices, body.triangles, {.is_rigid = false});
  scene.add_plane({0, 0, 0}, {0, 0, 1});

  EXPECT_EQ(scene.contacts().size(), 100U);
}

/// A bonded patch keeps its points while detection finds less of it, and averages beta over more.
TEST(RigidPatches, ABondKeepsItsPointsUntilThePatchGrows) {
  const auto scene_of = [](double z, double tilt) {
    auto scene = std::make_unique<PairScene>();
    adhere(*scene);
    Square body = fine_box({0, 0, z}, {1, 1, 1}, 4);
    for (Point3& x : body.vertices) x[2] += tilt * x[0];
    scene->add_mesh(body.vertices, body.triangles, {});
    scene->add_plane({0, 0, 0}, {0, 0, 1});
    return scene;
  };
  const double half_tilt = 2 * h;  // the far half is beyond twice the thickness
  ContactTrackerOptions options;
  options.materials = {{.stiffness = 1e6, .initial_intensity = 1}};
  options.touch_distance = h;
  ContactTracker tracker(options);
  const auto step = [&](PairScene& scene) {
    const auto& reports = scene.contacts(tracker.records());
    const std::size_t count = tracker.begin_step(reports, scene.places(), 0.01).size();
    ContactSolution rest;
    rest.impulse.assign(3 * count, 0);
    rest.velocity = rest.impulse;
    tracker.end_step(rest, scene.places());
  };
  const auto bonded = [&] {
    double sum = 0;
    for (const ContactRecord& record : tracker.records()) sum += record.area * record.intensity;
    return sum;
  };

  step(*scene_of(1.1 * h, half_tilt));
  const double part = bonded();
  EXPECT_GT(part, 0.3);
  EXPECT_LT(part, 0.7);
  step(*scene_of(1.1 * h, 0));  // all of it touches: the bond covers a part, the mean is kept
  EXPECT_NEAR(bonded(), part, 1e-12);
  double area = 0;
  for (const ContactRecord& record : tracker.records()) area += record.area;
  EXPECT_NEAR(area, 1, 1e-12);
  const std::vector<ContactRecord> before = tracker.records();
  step(*scene_of(1.1 * h, half_tilt));  // less of it: nothing changes
  EXPECT_NEAR(bonded(), part, 1e-12);
  step(*scene_of(5 * h, 0));  // pulled off beyond detection
  EXPECT_NEAR(bonded(), part, 1e-12);
  std::size_t points = 0;
  for (const ContactRecord& record : tracker.records()) {
    if (!(record.area > 0)) continue;
    const auto same = std::find_if(before.begin(), before.end(),
                                   [&](const ContactRecord& r) { return r.key == record.key; });
    ASSERT_NE(same, before.end());
    EXPECT_EQ(record.anchor_a, same->anchor_a);
    ++points;
  }
  EXPECT_EQ(points, 4U);
}
}  // namespace
}  // namespace tetwarp::test
