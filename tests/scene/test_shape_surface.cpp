/// @file test_shape_surface.cpp
/// Surfaces of shapes: closed, outwards, of about as many triangles as asked, on the shape.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "host/scene/shape.hpp"
#include "host/scene/shape_surface.hpp"
#include "host/scene/surface.hpp"
#include "tests/scene/shape_samples.hpp"
#include "tests/scene/surface_checks.hpp"

namespace tetwarp {
namespace {
using scene_checks::euler_number;
using scene_checks::is_manifold;
using scene_checks::named_shapes;

TEST(ShapeSurface, IsClosedAndOutwards) {
  for (const auto& [name, shape] : named_shapes()) {
    for (const std::int64_t triangles : {4, 100, 1280, 5000}) {
      const Surface surface = make_shape_surface(shape, triangles);

      EXPECT_TRUE(is_manifold(surface)) << name << " " << triangles;
      EXPECT_EQ(euler_number(surface), name == "torus" ? 0 : 2) << name << " " << triangles;
      EXPECT_NO_THROW(check_areas(name, surface));
      EXPECT_NO_THROW(check_closed(name, surface));
    }
  }
}

TEST(ShapeSurface, HasAboutAsManyTrianglesAsAsked) {
  for (const auto& [name, shape] : named_shapes()) {
    for (const double triangles : {400.0, 1280.0, 20000.0}) {
      const Surface surface = make_shape_surface(shape, static_cast<std::int64_t>(triangles));

      EXPECT_NEAR(static_cast<double>(surface.triangles.size()) / triangles, 1, 0.2) << name;
    }
  }
}

TEST(ShapeSurface, HasItsPointsOnTheShape) {
  for (const auto& [name, shape] : named_shapes()) {
    const auto level = make_level(shape);
    for (const Point3& x : make_shape_surface(shape, 500).points) {
      ASSERT_NEAR(level(x), 0, 1e-12) << name;
    }
  }
}

/// The volume between a curved surface and its chords is of second order in the triangles' edges.
TEST(ShapeSurface, EnclosesTheVolumeToSecondOrder) {
  for (const auto& [name, shape] : named_shapes()) {
    const double coarse = 1 - volume_of(make_shape_surface(shape, 1000)) / volume_of(shape);
    const double fine = 1 - volume_of(make_shape_surface(shape, 16000)) / volume_of(shape);

    EXPECT_LT(std::abs(coarse), 0.15) << name;
    if (name == "box" || name == "plate") {
      EXPECT_LT(std::abs(fine), 1e-12) << name;
    } else if (name != "bent strip") {
      EXPECT_NEAR(coarse / fine, 16, 5) << name;
    }
  }
}
}  // namespace
}  // namespace tetwarp
