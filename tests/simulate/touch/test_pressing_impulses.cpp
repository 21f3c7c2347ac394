/// @file test_pressing_impulses.cpp
/// What presses on areas of contacts: resultants are kept, and how a solve distributes impulses
/// over contacts does not count.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "host/base/point3.hpp"
#include "host/simulate/contact_step/pressing_impulses.hpp"
#include "host/simulate/patches/rigid_patches.hpp"

namespace tetwarp::test {
namespace {
constexpr double h = 1e-3;  // thickness

/// Contacts given by hand between two bodies of three nodes or vertices each.
class Hand {
 public:
  Hand(bool is_rigid_a, bool is_rigid_b, double bonding_rate = 1)
      : materials{{.bonding_rate = bonding_rate}} {
    surfaces.surfaces.thickness = h;
    surfaces.surfaces.bodies.resize(2);
    for (std::int32_t b = 0; b < 2; ++b) {
      surfaces.surfaces.bodies[b == 0 ? 0 : 1] = {.first_vertex = 3 * b,
                                                  .vertex_end = 3 * b + 3,
                                                  .is_rigid = b == 0 ? is_rigid_a : is_rigid_b};
    }
    for (std::int32_t n = 0; n < 6; ++n) {
      surfaces.vertex_point.push_back(
          {.body = n / 3, .node = {n, -1, -1, -1}, .weight = {1, 0, 0, 0}});
    }
  }

  TrackedContact& add(const ContactKey& key, const Point3& place, double area, double impulse) {
    TrackedContact contact;
    contact.key = key;
    contact.point_a_world = contact.point_b_world = place;
    contact.axes = axes;
    contacts.push_back(contact);
    records.push_back({.key = key, .area = area});
    impulses.insert(impulses.end(), {impulse, 0.3, -0.2});
    return contacts.back();
  }

  std::vector<double> spread() const {
    PressingImpulses pressing(surfaces, materials);
    const std::span<const double> values = pressing.spread(contacts, records, impulses);
    return {values.begin(), values.end()};
  }

  SceneSurfaces surfaces;
  std::vector<ContactMaterial> materials;
  std::array<Point3, 3> axes{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};
  std::vector<TrackedContact> contacts;
  std::vector<ContactRecord> records;
  std::vector<double> impulses;
};

ContactKey point_key(std::int32_t slot, std::int32_t point) {
  constexpr std::int32_t first = RigidPatches::first_feature;
  return {0, first - 4 * slot - point, 1, first};
}

/// Four points with a quarter of an area each, at c +- half_x e_1 and c +- half_y e_2.
void add_points(Hand& hand, double half_x, double half_y) {
  for (std::int32_t n = 0; n < 4; ++n) {
    const Point3& axis = hand.axes[n < 2 ? 1 : 2];
    const double half = (n < 2 ? half_x : half_y) * (n % 2 == 0 ? 1 : -1);
    hand.add(point_key(0, n), times(half, axis), 0.25, 0);
  }
}

std::array<Point3, 3> random_axes(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return unit(Point3{normal(random), normal(random), normal(random)}); };
  const Point3 n = draw(), t = unit(cross(n, draw()));
  return {n, t, cross(n, t)};
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Force and moment of the impulses of supports, in any direction, are those of the points.
TEST(PressingImpulses, KeepForceAndMomentOfAPatch) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-0.3, 0.3), size(0, 2);
  for (int run = 0; run < 200; ++run) {
    Hand hand(true, true);
    hand.axes = random_axes(random);
    add_points(hand, 1, 0.8);
    Point3 moment{0, 0, 0};
    double force = 0;
    for (std::int32_t n = 0; n < 7; ++n) {
      const Point3 at =
          plus(times(place(random), hand.axes[1]), times(place(random), hand.axes[2]));
      const double impulse = n % 3 == 0 ? 0 : size(random);
      hand.add({0, n, 1, n}, at, 0, impulse);
      force += impulse;
      moment = plus(moment, times(impulse, at));
    }

    const std::vector<double> pressing = hand.spread();

    Point3 spread{0, 0, 0};
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_GE(pressing[c], 0);
      spread = plus(spread, times(pressing[c], hand.contacts[c].point_a_world));
    }
    for (std::size_t c = 4; c < pressing.size(); ++c) EXPECT_EQ(pressing[c], 0);
    EXPECT_NEAR(sum_of(pressing), force, 1e-13 * (1 + force));
    EXPECT_LT(norm(minus(spread, moment)), 1e-13 * (1 + force)) << run;
  }
}

/// A load outside of the patch would pull at its far side: that is left out, the force is kept.
TEST(PressingImpulses, PullAtNoPointOfAPatch) {
  Hand hand(true, true);
  add_points(hand, 1, 0.8);
  hand.add({0, 0, 1, 0}, {1.5, 0, 0}, 0, 2);

  const std::vector<double> pressing = hand.spread();

  EXPECT_EQ(pressing[1], 0);
  EXPECT_GT(pressing[0], pressing[2]);
  EXPECT_NEAR(sum_of(pressing), 2, 1e-14);
}

/// In a step that closes the patch, points that are more open than what pushes have nothing.
TEST(PressingImpulses, LeaveOutPointsThatDoNotTouchYet) {
  Hand hand(true, true);
  add_points(hand, 1, 0.8);
  hand.contacts[1].gap[0] = 2 * h;
  hand.add({0, 0, 1, 0}, {0, 0, 0}, 0, 2).gap[0] = h;

  const std::vector<double> pressing = hand.spread();

  EXPECT_EQ(pressing[1], 0);
  EXPECT_NEAR(sum_of(pressing), 2, 1e-14);
}

MaterialPoint on_vertices(std::int32_t v, std::int32_t w, double share) {
  return {.vertex = {v, w, -1}, .weight = {share, 1 - share, 0}};
}

/// Three vertices of body a with areas, and contacts without area along its edges: of a rigid body
/// b, or of the same places of a deformable one.
Hand sheet_on(bool is_rigid, bool on_edges) {
  Hand hand(false, is_rigid);
  const std::array<double, 3> area{0.2, 0.3, 0.5}, impulse{4, 1, 2}, along{0.5, 0.25, 0.8};
  std::array<double, 3> left = impulse;
  for (std::int32_t v = 0; on_edges && v < 3; ++v) {
    // So much that what an edge carries is missing at the vertices.
    const std::int32_t w = (v + 1) % 3;
    const auto i = static_cast<std::size_t>(v), j = static_cast<std::size_t>(w);
    const double part = 0.5;
    TrackedContact& edge = hand.add({0, 10 + v, 1, 10 + v}, {0, 0, 0}, 0, part);
    edge.material_a = edge.material_b = on_vertices(v, w, along[i]);
    left[i] -= along[i] * part;
    left[j] -= (1 - along[i]) * part;
  }
  for (std::int32_t v = 0; v < 3; ++v) {
    const auto i = static_cast<std::size_t>(v);
    TrackedContact& vertex = hand.add({0, v, 1, v}, {0, 0, 0}, area[i], left[i]);
    vertex.material_a = vertex.material_b = on_vertices(v, -1, 1);
  }
  return hand;
}

/// The forces on nodes are the same, so is what presses, and its sum is the whole.
TEST(PressingImpulses, DoNotDependOnWhichContactsOfADeformableBodyPush) {
  for (const bool is_rigid : {true, false}) {
    const std::vector<double> at_vertices = sheet_on(is_rigid, false).spread();
    const std::vector<double> along_edges = sheet_on(is_rigid, true).spread();

    ASSERT_EQ(at_vertices.size(), 3u);
    ASSERT_EQ(along_edges.size(), 6u);
    EXPECT_NEAR(sum_of(at_vertices), 7, 1e-14);
    for (std::size_t v = 0; v < 3; ++v) {
      EXPECT_EQ(along_edges[v], 0);
      EXPECT_NEAR(along_edges[3 + v], at_vertices[v], 1e-14) << is_rigid;
    }
  }
}

/// Contacts of a node share its force by their areas.
TEST(PressingImpulses, OfOneNodeAreInProportionToAreas) {
  Hand hand(false, true);
  for (std::int32_t n = 0; n < 3; ++n) {
    hand.add({0, n, 1, n}, {0, 0, 0}, 0.1 * (n + 1), n == 0 ? 6 : 0).material_a =
        on_vertices(0, -1, 1);
  }

  const std::vector<double> pressing = hand.spread();

  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(pressing[n], static_cast<double>(n + 1), 1e-14);
  }
}

/// The same body on both sides: each side presses with half, whatever the order of sides, by which
/// normals turn round.
TEST(PressingImpulses, OfABodyWithItselfHaveTheForceOfBothSides) {
  for (const bool is_turned : {false, true}) {
    Hand hand(false, true);
    const ContactKey first{0, 0, 0, 1}, second{0, 1, 0, 2};
    TrackedContact& a = hand.add(first, {0, 0, 0}, 0.4, 3);
    a.material_a = on_vertices(0, -1, 1);
    a.material_b = on_vertices(1, -1, 1);
    if (is_turned) hand.axes[0] = times(-1, hand.axes[0]);
    TrackedContact& b = hand.add(second, {0, 0, 0}, 0.4, 1);
    b.material_a = on_vertices(is_turned ? 1 : 0, -1, 1);
    b.material_b = on_vertices(is_turned ? 0 : 1, -1, 1);

    const std::vector<double> pressing = hand.spread();

    EXPECT_NEAR(pressing[0], 2, 1e-14) << is_turned;
    EXPECT_NEAR(pressing[1], 2, 1e-14) << is_turned;
  }
}

/// Faces at a right angle: what presses on one does not press on the other.
TEST(PressingImpulses, StayOnAreasThatFaceTheSameWay) {
  Hand hand(false, true);
  hand.add({0, 0, 1, 0}, {0, 0, 0}, 0.4, 3).material_a = on_vertices(0, -1, 1);
  hand.axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  hand.add({0, 1, 1, 1}, {0, 0, 0}, 0.4, 1).material_a = on_vertices(0, -1, 1);

  EXPECT_EQ(hand.spread(), (std::vector<double>{3, 1}));
}

/// A contact that closes within the step has its own impulse.
TEST(PressingImpulses, OfAnOpenContactAreItsOwn) {
  Hand hand(false, true);
  hand.add({0, 0, 1, 0}, {0, 0, 0}, 0.4, 3).material_a = on_vertices(0, -1, 1);
  TrackedContact& open = hand.add({0, 1, 1, 1}, {0, 0, 0}, 0.4, 1);
  open.material_a = on_vertices(0, -1, 1);
  open.gap[0] = h;

  EXPECT_EQ(hand.spread(), (std::vector<double>{3, 1}));
}

TEST(PressingImpulses, AreNotMadeWhereNoBondForms) {
  Hand hand(false, true, 0);
  hand.add({0, 0, 1, 0}, {0, 0, 0}, 0.4, 3).material_a = on_vertices(0, -1, 1);

  EXPECT_TRUE(hand.spread().empty());
}
}  // namespace
}  // namespace tetwarp::test
