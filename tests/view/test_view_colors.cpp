/// @file test_view_colors.cpp
/// Colors in live windows: values on surfaces, curves of volumes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "host/base/point3.hpp"
#include "host/view/curve_editor.hpp"
#include "host/view/look/look_surfaces.hpp"
#include "host/view/look/value_colors.hpp"
#include "tests/view/live_scene.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

/// Means of a constant are the constant, and means lie between the extremes, whatever the mesh.
TEST(SurfaceMeans, KeepConstantsAndExtremes) {
  const Simulator simulator(live_scene());
  const BodyMesh& body = simulator.body(0);
  const BoundPoints binding = LookSurfaces(simulator).binding(0);
  std::vector<double> values(body.mesh.tets.size(), 2.5);
  for (const float mean : surface_means(body.mesh, values, binding)) EXPECT_NEAR(mean, 2.5, 1e-6);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-4, 9);
  for (double& value : values) value = any(random);
  const std::vector<float> means = surface_means(body.mesh, values, binding);
  ASSERT_EQ(means.size(), body.surface.points.size());
  for (const float mean : means) {
    EXPECT_GE(mean, *std::ranges::min_element(values) - 1e-6);
    EXPECT_LE(mean, *std::ranges::max_element(values) + 1e-6);
  }
}

/// A ball that rests on a block: gaps and adhesion are those of the contacts, at points near them,
/// and the stress is nowhere on the ball.
TEST(SurfaceValues, AreThoseOfTheContactsNearby) {
  Scene scene = live_scene();
  scene.contact.material.adhesion = AdhesionMaterial{
      .stiffness = 1e6, .energy = 0.1, .bonding_rate = 0.01, .saturation_pressure = 100};
  Simulator simulator(scene);
  const LookSurfaces looks(simulator);
  SurfaceValues values(simulator, looks);
  for (int n = 0; n < 40; ++n) simulator.step();
  const std::vector<ContactPoint> contacts = simulator.contacts();
  ASSERT_FALSE(contacts.empty());
  EXPECT_TRUE(values.of(SurfaceQuantity::none).empty());
  const auto gaps = values.of(SurfaceQuantity::gap);
  const auto bonds = values.of(SurfaceQuantity::adhesion);
  for (std::size_t b = 0; b < 2; ++b) {
    const std::vector<Point3> points = simulator.surface_positions(b);
    ASSERT_EQ(gaps[b].size(), points.size());
    int found = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      EXPECT_EQ(std::isnan(gaps[b][p]), std::isnan(bonds[b][p]));
      if (std::isnan(gaps[b][p])) continue;
      ++found;
      const auto has = [&](const auto& member, float value) {
        return std::ranges::any_of(contacts, [&](const ContactPoint& contact) {
          return static_cast<float>(contact.*member) == value &&
                 norm(minus(contact.position, points[p])) < 0.06;
        });
      };
      EXPECT_TRUE(has(&ContactPoint::gap, gaps[b][p]));
      EXPECT_TRUE(has(&ContactPoint::intensity, bonds[b][p]));
    }
    EXPECT_GT(found, 0) << "body " << b;
  }
  const auto stresses = values.of(SurfaceQuantity::stress);
  EXPECT_TRUE(std::ranges::all_of(stresses[1], [](float value) { return std::isnan(value); }));
  const std::vector<double> of_cells = simulator.cell_stresses(0);
  const double most = *std::ranges::max_element(of_cells);
  for (const float value : stresses[0]) {
    EXPECT_GE(value, 0);
    EXPECT_LE(value, most * (1 + 1e-6));
  }
}

TEST(ValueRange, GrowsWithItsQuantity) {
  ValueRange range;
  range.include(SurfaceQuantity::stress, {{3, NAN}, {5}});
  EXPECT_EQ(range.low(), 0);
  EXPECT_EQ(range.high(), 5);
  EXPECT_NEAR(range.share(2.5), 0.5, 1e-12);
  range.include(SurfaceQuantity::stress, {{1}});
  EXPECT_EQ(range.high(), 5);
  range.include(SurfaceQuantity::gap, {{NAN}, {-1e-3F, 2e-3F}});
  EXPECT_NEAR(range.low(), -1e-3, 1e-9);
  EXPECT_NEAR(range.high(), 2e-3, 1e-9);
  range.include(SurfaceQuantity::gap, {{INFINITY, -INFINITY, 3e-3F}});
  EXPECT_NEAR(range.low(), -1e-3, 1e-9);
  EXPECT_NEAR(range.high(), 3e-3, 1e-9);
  range.include(SurfaceQuantity::adhesion, {});
  EXPECT_EQ(range.low(), 0);
  EXPECT_EQ(range.high(), 1);
  range.include(SurfaceQuantity::stress, {{0}});
  EXPECT_EQ(range.share(0), 0) << "a range without extent";
}

TEST(ValueColor, RunsFromBlueToRed) {
  EXPECT_GT(value_color(0)[2], value_color(0)[0]);
  EXPECT_GT(value_color(1)[0], value_color(1)[2]);
  EXPECT_EQ(value_color(-3), value_color(0));
  EXPECT_EQ(value_color(7), value_color(1));
  for (double share = 0; share < 1; share += 0.01) {
    const Rgb now = value_color(share), next = value_color(share + 0.01);
    // Green falls by 0.75 within the last quarter.
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LE(std::abs(now[c] - next[c]), 0.03 + 1e-12);
  }
}

std::vector<ColorPoint> some_curve() {
  return VolumeColors("ct", -1000, 1000).curve();
}

TEST(VolumeColors, TakeTheCurveThatTheyGive) {
  VolumeColors colors("ct", -800, 1500);
  const std::vector<ColorPoint> curve = colors.curve(), points = colors.points();
  EXPECT_EQ(curve.front().value, 0);
  EXPECT_EQ(curve.back().value, 1);
  VolumeColors other("mr", 0, 1);  // with fewer points
  other.set_curve(curve);
  EXPECT_EQ(other.points().back().value, largest_sample);
  EXPECT_EQ(other.points().size(), curve.size());
  colors.set_curve(curve);
  for (std::size_t n = 0; n < points.size(); ++n) {
    EXPECT_NEAR(colors.points()[n].value, points[n].value, 1e-9);
    EXPECT_EQ(colors.points()[n].color, points[n].color);
  }
}

/// Wherever the mouse goes, opacities stay shares and samples do not fall.
TEST(CurveEditor, KeepsTheOrderOfItsPoints) {
  CurveEditor editor(some_curve());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-0.5, 1.5);
  for (int trial = 0; trial < 500; ++trial) {
    const std::size_t point = random() % editor.curve().size();
    const double x = any(random), y = any(random);
    editor.drag(point, x, y);
    editor.tint(point, any(random), any(random));
    EXPECT_EQ(editor.curve()[point].opacity, std::clamp(y, 0.0, 1.0));
    EXPECT_EQ(editor.curve().front().value, 0);
    EXPECT_EQ(editor.curve().back().value, 1);
    EXPECT_TRUE(std::ranges::is_sorted(editor.curve(), {}, &ColorPoint::value));
    for (const double part : editor.curve()[point].color) {
      EXPECT_GE(part, 0);
      EXPECT_LE(part, 1);
    }
  }
}

/// Screens get a curve only then.
TEST(CurveEditor, IsEditedOnceAPointIsDraggedOrTinted) {
  CurveEditor dragged(some_curve()), tinted(some_curve());
  EXPECT_TRUE(dragged.edited().empty());
  EXPECT_TRUE(dragged.hit(dragged.curve()[1].value, dragged.curve()[1].opacity));
  EXPECT_TRUE(dragged.edited().empty());
  dragged.drag(1, 0.3, 0.6);
  tinted.tint(2, 0.1, 0);
  EXPECT_EQ(dragged.edited().size(), dragged.curve().size());
  EXPECT_EQ(dragged.edited()[1].opacity, 0.6);
  EXPECT_EQ(tinted.edited()[2].color, tinted.curve()[2].color);
}

TEST(CurveEditor, FindsThePointUnderThePointer) {
  const CurveEditor editor(some_curve());
  for (std::size_t n = 0; n < editor.curve().size(); ++n) {
    const ColorPoint& point = editor.curve()[n];
    const auto found = editor.hit(point.value + 0.005, point.opacity);
    ASSERT_TRUE(found);
    EXPECT_EQ(*found, n);
  }
  EXPECT_FALSE(editor.hit(0.5, 0.9));
}

/// Three thirds of the circle of hues are the color again, and a third takes red to green.
TEST(CurveEditor, TurnsHues) {
  CurveEditor editor({{0, {0.8, 0.2, 0.2}, 0}, {1, {0.3, 0.3, 0.3}, 1}});
  editor.tint(0, 1.0 / 3, 0);
  EXPECT_NEAR(editor.curve()[0].color[0], 0.2, 1e-12);
  EXPECT_NEAR(editor.curve()[0].color[1], 0.8, 1e-12);
  EXPECT_NEAR(editor.curve()[0].color[2], 0.2, 1e-12);
  editor.tint(0, 2.0 / 3, 0);
  EXPECT_NEAR(editor.curve()[0].color[0], 0.8, 1e-12);
  EXPECT_NEAR(editor.curve()[0].color[1], 0.2, 1e-12);
  editor.tint(1, 0.4, 0);
  EXPECT_EQ(editor.curve()[1].color, (std::array<double, 3>{0.3, 0.3, 0.3})) << "gray has no hue";
}

}  // namespace
}  // namespace tetwarp::test
