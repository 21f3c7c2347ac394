/// @file test_pair_contacts.cpp
/// Contacts of simple configurations: points, normals, gaps, areas, which pairs become contacts.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulate/pair_scene.hpp"

namespace tetwarp::test {
namespace {
TEST(PairContacts, AnElasticBoxOnAPlaneHasTheAreaOfItsBottom) {
  PairScene scene;
  const Square body = box({0, 0, 1.5 * h}, {2, 3, 1});
  scene.add_mesh(body.vertices, body.triangles, {.is_rigid = false});
  scene.add_plane({0, 0, 0}, {0, 0, 1});

  const auto& contacts = scene.contacts();

  ASSERT_EQ(contacts.size(), 4U);
  EXPECT_NEAR(area_of(contacts), 6, 1e-14);
  for (const ReportedContact& contact : contacts) {
    EXPECT_EQ(contact.normal, (Point3{0, 0, 1}));
    EXPECT_NEAR(gap_of(contact), 0.5 * h, 1e-15);
    EXPECT_EQ(contact.point_a_world[2],
              1.5 * h);  // the plane does not move: its point does not count
    EXPECT_EQ(contact.material_a.vertex[0], contact.key.feature_a);
    EXPECT_EQ(contact.key.feature_b, -1);
  }
}

TEST(PairContacts, RoundBodiesTouchAtTheirSurfaces) {
  const double r = 0.3;
  const Point3 down{0.5, 0, -0.1};
  PairScene on_plane;
  on_plane.add_sphere({0, 0, r + 0.05}, r, {.way = down});
  on_plane.add_capsule({2, 0, r + 0.05}, {3, 0, r + 0.05}, r, {.way = down});
  on_plane.add_plane({0, 0, 0}, {0, 0, 1});
  const std::vector<ReportedContact> contacts = on_plane.contacts();

  ASSERT_EQ(contacts.size(), 3U);  // the sphere and both ends of the capsule
  for (const ReportedContact& contact : contacts) {
    EXPECT_NEAR(gap_of(contact), 0.05 - h, 1e-14);
    EXPECT_NEAR(contact.point_a_world[2], 0.05, 1e-14);
    EXPECT_EQ(contact.area, 0);
    expect_near(contact.tangent, {1, 0, 0}, 1e-14);
  }

  PairScene spheres;
  const Point3 direction = unit(Point3{1, 2, -2});
  spheres.add_sphere({0, 0, 0}, r, {});
  spheres.add_sphere(times(2 * r + 1.5 * h, direction), r, {});
  const std::vector<ReportedContact> two = spheres.contacts();

  ASSERT_EQ(two.size(), 1U);
  expect_near(two[0].normal, times(-1, direction), 1e-14);
  EXPECT_NEAR(gap_of(two[0]), 0.5 * h, 1e-14);
  // Both move: the thickness is shared, so that impulses act at one point once the gap is closed.
  expect_near(plus(two[0].point_a_world, two[0].point_b_world), times(2 * r + 1.5 * h, direction),
              1e-14);

  PairScene capsules;
  capsules.add_capsule({-1, 0, 0}, {1, 0, 0}, r, {});
  capsules.add_capsule({0.2, -1, 2 * r + 1.5 * h}, {0.2, 1, 2 * r + 1.5 * h}, r, {});
  const std::vector<ReportedContact> crossed = capsules.contacts();

  ASSERT_EQ(crossed.size(), 1U);
  expect_near(crossed[0].normal, {0, 0, -1}, 1e-14);
  EXPECT_NEAR(crossed[0].point_a_world[0], 0.2, 1e-14);
  EXPECT_NEAR(gap_of(crossed[0]), 0.5 * h, 1e-14);
}

/// At both ends of what they share; crossed by a few degrees where they are nearest, too.
TEST(PairContacts, CapsulesSideBySideTouchAtBothEndsOfTheirOverlap) {
  const double r = 0.3, z = 2 * r + 1.5 * h;
  PairScene parallel;
  parallel.add_capsule({-1, 0, 0}, {1, 0, 0}, r, {});
  parallel.add_capsule({3, 0, z}, {0.4, 0, z}, r, {});
  const std::vector<ReportedContact> two = parallel.contacts();
  ASSERT_EQ(two.size(), 2U);
  EXPECT_NEAR(two[0].point_a_world[0], 0.4, 1e-14);
  EXPECT_NEAR(two[1].point_a_world[0], 1, 1e-14);
  for (const ReportedContact& contact : two) {
    expect_near(contact.normal, {0, 0, -1}, 1e-14);
    EXPECT_NEAR(gap_of(contact), 0.5 * h, 1e-14);
    EXPECT_EQ(contact.area, 0);
  }
  EXPECT_NE(two[0].key, two[1].key);

  PairScene crossed;
  crossed.add_capsule({-1, 0, 0}, {1, 0, 0}, r, {});
  crossed.add_capsule({-1, -0.1, z}, {1, 0.1, z}, r, {});
  const std::vector<ReportedContact> three = crossed.contacts();
  ASSERT_EQ(three.size(), 3U);
  EXPECT_NEAR(gap_of(three[0]), 0.5 * h, 1e-14);  // where they are nearest
  EXPECT_NEAR(three[0].point_a_world[0], 0, 1e-12);
  EXPECT_GT(gap_of(three[1]), 5 * h);
  EXPECT_GT(gap_of(three[2]), 5 * h);

  PairScene in_line;  // no overlap
  in_line.add_capsule({-1, 0, 0}, {0, 0, 0}, r, {});
  in_line.add_capsule({z, 0, 0}, {2, 0, 0}, r, {});
  EXPECT_EQ(in_line.contacts().size(), 1U);
}

TEST(PairContacts, EdgesTouchWhereTheyCross) {
  PairScene scene;
  const std::vector<std::array<std::int32_t, 3>> one = {{0, 1, 2}};
  scene.add_mesh({{-1, 0, 0}, {1, 0, 0}, {0, 0, -1}}, one, {});
  scene.add_mesh({{0.25, -1, 1.2 * h}, {0.25, 1, 1.2 * h}, {0.25, 0, 1}}, one, {});

  const auto& contacts = scene.contacts();

  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0].area, 0);
  expect_near(contacts[0].normal, {0, 0, -1}, 1e-14);
  EXPECT_NEAR(gap_of(contacts[0]), 0.2 * h, 1e-15);
  expect_near(contacts[0].point_a_world, {0.25, 0, 0.1 * h + 0.4 * h}, 1e-15);
  EXPECT_GE(contacts[0].key.feature_a, 6);  // edges after vertices
}

/// An edge that leans over an even face of the other body is no contact with the edges in it: what
/// slides along the face would be held up there.
TEST(PairContacts, EdgesWithinAnEvenFaceDoNotHoldUpWhatLeans) {
  PairScene scene;
  const Square ground = square(10, 0, true);
  scene.add_mesh(ground.vertices, ground.triangles, still());
  const double lean =
      4 * h;  // from its lowest vertex the edge has risen by 0.7 h over the next edge
  scene.add_mesh({{0.5 - lean, 0.55, 1.1 * h}, {0.6, 0.552, 0.02}, {0.55, 0.57, 0.5}}, {{0, 1, 2}},
                 {.is_rigid = false});

  const auto& contacts = scene.contacts();

  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0].normal, (Point3{0, 0, -1}));
  EXPECT_EQ(contacts[0].key.feature_a, -1);
}

TEST(PairContacts, AreasOfTwoMeshesAddUpToWhatTouches) {
  for (const auto& [m, n] : {std::pair{4, 4}, {8, 8}, {4, 16}, {16, 4}, {12, 9}, {16, 16}}) {
    PairScene scene;
    const Square below = square(m, 0, true), above = square(n, 1.5 * h, false);
    scene.add_mesh(below.vertices, below.triangles, {.is_rigid = false});
    scene.add_mesh(above.vertices, above.triangles, {.is_rigid = false});

    const auto& contacts = scene.contacts();

    EXPECT_NEAR(area_of(contacts), 1, 1e-12) << m << " " << n;
    for (const ReportedContact& contact : contacts) {
      expect_near(contact.normal, {0, 0, -1}, 1e-12);
      EXPECT_NEAR(gap_of(contact), 0.5 * h, 1e-14);
    }
  }
}

/// A fast body: the points of the material that meet, and their gap at the start.
TEST(PairContacts, AHitOnTheWayHasTheGapOfTheStart) {
  PairScene scene;
  const Square ground = square(1, 0, true);
  scene.add_mesh(ground.vertices, ground.triangles, still());
  scene.add_mesh({{0.1, 0.2, 0.5}, {0.1, 0.25, 1}, {0.15, 0.2, 1}}, {{0, 1, 2}},
                 {.way = {0.8, 0, -0.9}});

  const auto& contacts = scene.contacts();

  ASSERT_EQ(contacts.size(), 1U);
  const ReportedContact& contact = contacts[0];
  EXPECT_NEAR(gap_of(contact), 0.5 - h, 1e-13);
  expect_near(contact.point_b_world, {0.1, 0.2, 0.5}, 1e-15);
  expect_near(contact.normal, {0, 0, -1}, 1e-12);
  EXPECT_NEAR(contact.point_a_world[0], 0.1 + 0.8 * 0.5 / 0.9, 2e-3);  // at the hit
  expect_near(contact.tangent, {-1, 0, 0}, 1e-12);  // of body 0 relative to body 1
}

/// What touches is seen along the normal; a bond keeps the area that it was made with.
TEST(PairContacts, ABondKeepsItsAreaAsItsSurfaceTurnsAway) {
  PairScene scene;
  Square sheet = square(1, 1.5 * h, true);
  for (Point3& x : sheet.vertices) x = {0.5 * x[0], x[1], 1.5 * h + std::sqrt(0.75) * x[0]};
  scene.add_mesh(sheet.vertices, sheet.triangles, {.is_rigid = false});
  scene.add_plane({0, 0, 0}, {0, 0, 1});
  const auto area_with = [&](double intensity, double area) {
    std::vector<ContactRecord> records;
    for (const ReportedContact& contact : scene.contacts()) {
      ContactRecord& record = records.emplace_back();
      record.key = contact.key;
      record.area = area;
      record.intensity = intensity;
    }
    EXPECT_EQ(records.size(), 2U);
    return area_of(scene.contacts(records));
  };

  EXPECT_NEAR(area_with(0, 0.25), 0.25, 1e-14);  // half the sheet's, at 60 degrees
  EXPECT_NEAR(area_with(0.1, 0.25), 0.5, 1e-14);
  EXPECT_NEAR(area_with(0.1, 0.01), 0.25, 1e-14);
}

/// A tip at a distance from the bottom of a valley, whose sides rise by 10 degrees.
PairScene tip_in_valley(double x) {
  const double rise = std::tan(0.1745), y = 0.3, z = 1.3 * h;
  PairScene scene;
  scene.add_mesh(
      {{-1, -1, rise}, {0, -1, 0}, {0, 1, 0}, {-1, 1, rise}, {1, -1, rise}, {1, 1, rise}},
      {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}}, still());
  scene.add_mesh({{x, y, z}, {x - 0.1, y - 0.1, 0.1}, {x + 0.1, y - 0.1, 0.1}, {x, y + 0.1, 0.1}},
                 {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}}, {.is_rigid = false});
  return scene;
}

/// It touches both sides. The nearer one has its area, or the one that it is bonded to.
TEST(PairContacts, ATipBetweenTwoFacesHasItsAreaOnce) {
  PairScene left = tip_in_valley(-0.2 * h), right = tip_in_valley(0.2 * h);
  const std::vector<ReportedContact> before = left.contacts();
  ASSERT_EQ(before.size(), 2U);
  const double area = area_of(before);
  ASSERT_GT(area, 0);
  for (const double intensity : {0.0, 0.5}) {
    std::vector<ContactRecord> records;
    for (const ReportedContact& contact : before) {
      records.push_back({.key = contact.key,
                         .area = contact.area,
                         .intensity = contact.area > 0 ? intensity : 0,
                         .normal_world = contact.normal});
    }
    const std::vector<ReportedContact> after = right.contacts(records);
    ASSERT_EQ(after.size(), 2U);
    EXPECT_NEAR(area_of(after), area, 1e-12) << intensity;
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_EQ(after[c].key, before[c].key);
      EXPECT_EQ(after[c].area > 0, (before[c].area > 0) == (intensity > 0)) << intensity;
    }
  }
}

/// Bodies in the other order: the same contacts with sides exchanged.
TEST(PairContacts, TheOrderOfBodiesChangesNothing) {
  const Square below = fine_box({0, 0, -1}, {1, 1, 0}, 3);
  const Square above = fine_box({0.3, 0.2, 1.3 * h}, {1.2, 0.9, 1}, 2);
  PairScene one, other;
  one.add_mesh(below.vertices, below.triangles, {.is_rigid = false});
  one.add_mesh(above.vertices, above.triangles, {.is_rigid = false});
  other.add_mesh(above.vertices, above.triangles, {.is_rigid = false});
  other.add_mesh(below.vertices, below.triangles, {.is_rigid = false});
  const std::vector<ReportedContact> contacts = one.contacts(), exchanged = other.contacts();

  ASSERT_EQ(contacts.size(), exchanged.size());
  EXPECT_NEAR(area_of(contacts), area_of(exchanged), 1e-14);
  for (const ReportedContact& contact : contacts) {
    const bool is_found =
        std::any_of(exchanged.begin(), exchanged.end(), [&](const ReportedContact& same) {
          return norm(minus(contact.point_a_world, same.point_b_world)) < 1e-14 &&
                 norm(minus(contact.point_b_world, same.point_a_world)) < 1e-14 &&
                 norm(plus(contact.normal, same.normal)) < 1e-14 &&
                 std::abs(contact.area - same.area) < 1e-15;
        });
    EXPECT_TRUE(is_found) << contact.key.feature_a << " " << contact.key.feature_b;
  }
}
}  // namespace
}  // namespace tetwarp::test
