/// @file test_shape_surface.cpp
/// Surfaces of shapes: closed, outwards, of about as many triangles as asked, on the shape.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "host/scene/shapes/shape.hpp"
#include "host/scene/shapes/shape_surface.hpp"
#include "host/scene/shapes/surface.hpp"
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

/// Flat faces and straight parts that are not divided bound the same solid.
TEST(ShapeSurface, OfWholeFacesEnclosesTheSameSolid) {
  for (const auto& [name, shape] : named_shapes()) {
    const Surface divided = make_shape_surface(shape, 1280);
    const Surface whole = make_shape_surface(shape, 1280, Faces::whole);

    EXPECT_TRUE(is_manifold(whole)) << name;
    EXPECT_NEAR(volume_of(whole) / volume_of(divided), 1, 1e-12) << name;
    const bool is_flat = name == "box" || name == "plate";
    const bool bends_everywhere = name == "sphere" || name == "ellipsoid" ||
                                  name == "round capsule" || name == "torus" ||
                                  name.find("arc") != std::string::npos;
    if (is_flat) {
      EXPECT_EQ(whole.triangles.size(), 12u) << name;
    } else if (bends_everywhere) {
      EXPECT_EQ(whole.triangles, divided.triangles) << name;
    } else {
      EXPECT_LT(whole.triangles.size(), divided.triangles.size()) << name;
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
