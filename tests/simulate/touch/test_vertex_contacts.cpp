/// @file test_vertex_contacts.cpp
/// Which parts of a body a vertex, or a ball, has contacts with.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulate/pair_scene.hpp"

namespace tetwarp::test {
namespace {
TEST(VertexContacts, AVertexOverAnEvenEdgeIsOneContactAndInACornerTwo) {
  for (const auto& [x, y] : {std::pair{0.25, 0.25}, {0.37, 0.37}, {0.37, 0.37 + 0.2 * h}}) {
    PairScene scene;
    const Square ground = square(2, 0, true);
    scene.add_mesh(ground.vertices, ground.triangles, still());
    scene.add_mesh({{x, y, 1.2 * h}, {x + 0.1, y, 1}, {x, y + 0.1, 1}}, {{0, 1, 2}},
                   {.is_rigid = false});

    const auto& contacts = scene.contacts();

    ASSERT_EQ(contacts.size(), 1U) << x;
    EXPECT_EQ(contacts[0].key.feature_a, -1);
    expect_near(contacts[0].normal, {0, 0, -1}, 1e-14);
    EXPECT_EQ(contacts[0].material_b.vertex[0], 0);
  }
  PairScene corner;
  const std::vector<Point3> floor_and_wall = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},
                                              {0, 1, 0}, {0, 0, 1}, {0, 1, 1}};
  corner.add_mesh(floor_and_wall, {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {0, 5, 4}}, still());
  corner.add_mesh({{1.5 * h, 0.6, 1.2 * h}, {1, 0.5, 1}, {1, 0.7, 1}}, {{0, 1, 2}}, {});

  const auto& contacts = corner.contacts();

  ASSERT_EQ(contacts.size(), 2U);
  expect_near(contacts[1].normal, {0, 0, -1}, 1e-14);  // the nearer one has the first number
  expect_near(contacts[0].normal, {-1, 0, 0}, 1e-14);
  EXPECT_EQ(contacts[1].key.feature_a, -1);
  EXPECT_EQ(contacts[0].key.feature_a, -2);
}

/// A vertex in a valley whose sides differ by 30 degrees keeps the number of each side, whichever
/// is nearer: impulses and bonds follow the numbers.
TEST(VertexContacts, NumbersFollowNormals) {
  const auto contacts_at = [](double x, const std::vector<ContactRecord>& records) {
    const double slope = std::tan(std::acos(-1.0) / 12);
    PairScene valley;
    valley.add_mesh(
        {{-1, 0, slope}, {0, 0, 0}, {1, 0, slope}, {-1, 1, slope}, {0, 1, 0}, {1, 1, slope}},
        {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}}, still());
    valley.add_mesh({{x, 0.4, 1.2 * h}, {0.1, 0.4, 1}, {-0.1, 0.5, 1}}, {{0, 1, 2}}, {});
    return std::vector<ReportedContact>(valley.contacts(records));
  };
  std::vector<ContactRecord> records;
  for (const ReportedContact& contact : contacts_at(0.1 * h, {})) {
    records.push_back({.key = contact.key, .normal_world = contact.normal});
  }
  ASSERT_EQ(records.size(), 2U);

  const auto alone = contacts_at(-0.1 * h, {}), after = contacts_at(-0.1 * h, records);

  ASSERT_EQ(alone.size(), 2U);
  ASSERT_EQ(after.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(after[k].key, records[k].key);
    expect_near(after[k].normal, records[k].normal_world, 1e-12);
    expect_near(alone[k].normal, records[1 - k].normal_world, 1e-12);
  }
}

/// A ball on a ring of 24 ridges that are about as near. Were the nearest ones chosen, others would
/// be in every step, and impulses would start anew.
TEST(VertexContacts, ABallInARingTouchesAllOfIt) {
  constexpr int ridges = 24;
  const double angle = 2 * std::acos(-1.0) / ridges, radius = 1 / std::cos(angle / 2);
  for (const int nearest : {0, 7}) {
    std::vector<Point3> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
    for (int k = 0; k < ridges; ++k) {
      const double c = std::cos(k * angle), s = std::sin(k * angle);
      const double own = radius - 0.1 * h * std::cos((k - nearest) * angle);
      vertices.insert(vertices.end(), {{own * c, own * s, 0}, {2 * c, 2 * s, 0.2}});
      const auto at = [&](int n) { return static_cast<std::int32_t>((2 * k + n) % (2 * ridges)); };
      triangles.insert(triangles.end(), {{at(0), at(2), at(1)}, {at(1), at(2), at(3)}});
    }
    PairScene scene;
    scene.add_sphere({0, 0, 0.5}, std::hypot(1, 0.5) - h, {.way = {0, 0, -h}});
    scene.add_mesh(vertices, triangles, {.is_rigid = false});

    EXPECT_EQ(scene.contacts().size(), static_cast<std::size_t>(ridges));
  }
}

}  // namespace
}  // namespace tetwarp::test
