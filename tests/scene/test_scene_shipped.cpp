/// @file test_scene_shipped.cpp
/// The scenes that ship with the library.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <tetwarp/names.hpp>
#include <variant>

#include "tests/scene/scene_texts.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
TEST(ShippedScenes, AreListedSortedAndParse) {
  const std::vector<std::string> names = scene_names();
  EXPECT_EQ(names, (std::vector<std::string>{"candy", "cantilever", "carps", "chain", "cloth",
                                             "cloth_peels", "mouth", "oranges", "peel", "sheet",
                                             "shoulder", "top", "torso"}));
  for (const std::string& name : names) {
    if (name == "carps" || name == "oranges" || name == "torso") continue;  // large images, below
    const Scene scene = shipped(name);
    EXPECT_NO_THROW(check_scene(scene)) << name;
    EXPECT_LE(scene.step_count(), name == "candy" || name == "peel" ? 4000 : 2000) << name;
  }
}

TEST(ShippedScenes, OfAnotherNameAreRefused) {
  EXPECT_EQ(message_of([] { scene_text("tops"); }),
            "'tops' is no scene that ships, expected candy, cantilever, carps, chain, cloth, "
            "cloth_peels, mouth, oranges, peel, sheet, shoulder, top, torso");
}

TEST(ShippedScenes, AreTheSameFromAFile) {
  const ScratchFolder folder;
  for (const std::string name :
       {"cantilever", "chain", "mouth", "peel", "sheet", "shoulder", "top"}) {
    const std::string file = folder / (name + ".json");
    std::ofstream(file) << scene_text(name);
    const Scene scene = shipped(name);
    const Scene read = read_scene(file);
    EXPECT_EQ(read.step_count(), scene.step_count());
    ASSERT_EQ(read.bodies.size(), scene.bodies.size());
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      EXPECT_EQ(read.bodies[b].name, scene.bodies[b].name);
      EXPECT_EQ(read.bodies[b].pose.position, scene.bodies[b].pose.position);
      EXPECT_EQ(read.bodies[b].geometry.index(), scene.bodies[b].geometry.index());
    }
  }
}

TEST(ShippedScenes, ChainAlternatesRigidAndElasticLinks) {
  const Scene chain = shipped("chain");
  ASSERT_EQ(chain.bodies.size(), 6u);
  ASSERT_EQ(chain.couplings.size(), 6u);
  for (std::size_t b = 0; b < 6; ++b) {
    EXPECT_EQ(chain.bodies[b].kind, b % 2 == 0 ? BodyKind::rigid : BodyKind::fem);
    // The points of a coupling lie in the faces that the two links share.
    const double face = chain.bodies[b].pose.position[0] - 0.05;
    for (const Point3& point : chain.couplings[b].points) EXPECT_NEAR(point[0], face, 1e-12);
  }
}

TEST(ShippedScenes, TorsoIsOnePersonOfTissueWithItsBaseFixed) {
  const Scene torso = shipped("torso");
  const auto& image = std::get<ImageGeometry>(torso.bodies.at(0).geometry);
  EXPECT_EQ(image.volume.grid.voxel_count(), 4'997'120);
  const auto samples = image.volume.samples<float>();
  const auto inside =
      std::count_if(samples.begin(), samples.end(), [&](float s) { return s >= image.threshold; });
  const double liters = 1e3 * 1.5e-3 * 1.5e-3 * 1.5e-3 * static_cast<double>(inside);
  EXPECT_NEAR(liters, 7, 1);
  const auto& base = std::get<BoxSelection>(torso.bodies[0].fixed.at(0));
  EXPECT_EQ(base.high[2], 0.01);
  const Handle& liver = torso.handles.at(0);
  EXPECT_EQ(liver.path.at(1).displacement, (Point3{0.03, 0, 0}));
  EXPECT_FALSE(liver.path.back().displacement);
  // The sphere lies in the phantom's liver, gray level 0.55.
  const Point3 center = std::get<SphereSelection>(liver.select.at(0)).center;
  std::size_t voxel = 0;
  for (const std::size_t axis : {2, 1, 0}) {
    const auto index = static_cast<std::size_t>(std::lround(center[axis] / 1.5e-3));
    voxel = voxel * static_cast<std::size_t>(image.volume.grid.dims[axis]) + index;
  }
  EXPECT_NEAR(samples[voxel], 0.55, 0.1);
}

TEST(ShippedScenes, CarpsSwimAnEighthOfAPeriodApart) {
  const Scene carps = shipped("carps");
  ASSERT_EQ(carps.bodies.size(), 8u);
  const auto& first = std::get<ImageGeometry>(carps.bodies[0].geometry);
  EXPECT_EQ(first.volume.grid.dims, (std::array<std::int64_t, 3>{204, 202, 512}));
  for (std::size_t b = 0; b < 8; ++b) {
    const auto& wave = std::get<Wave>(carps.bodies[b].motion);
    EXPECT_EQ(wave.phase, 0.125 * static_cast<double>(b));
    EXPECT_EQ(wave.envelope, (std::array<double, 3>{0.02, -0.08, 0.16}));
    EXPECT_EQ(std::get<ImageGeometry>(carps.bodies[b].geometry).volume.data, first.volume.data);
  }
  EXPECT_EQ(carps.step_count(), 60);
}
}  // namespace
}  // namespace tetwarp::test
