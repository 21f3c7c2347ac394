/// @file test_cli_simulate.cpp
/// `tetwarp simulate`: files, determinism, checkpoints, warped volumes, pictures.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <tetwarp/io.hpp>
#include <vector>

#include "tests/support/h5_numbers.hpp"
#include "tests/support/simulate_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

void expect_equal_results(const SimulateScene& scene, const std::string& a, const std::string& b) {
  for (const char* name : {"beam.vtkhdf", "beam.surface.vtkhdf", "ball.vtkhdf", "fruit.vtkhdf"}) {
    EXPECT_EQ(h5_numbers(scene.in(a, name), "VTKHDF/PointData/displacement"),
              h5_numbers(scene.in(b, name), "VTKHDF/PointData/displacement"))
        << name;
    EXPECT_EQ(h5_numbers(scene.in(a, name), "VTKHDF/Steps/Values"),
              h5_numbers(scene.in(b, name), "VTKHDF/Steps/Values"));
  }
  for (const char* name :
       {"time", "energy/total", "energy/work", "momentum", "linear_iterations",
        "bodies/ball/rotation", "bodies/beam/support_force", "couplings/ball-world/force"}) {
    EXPECT_EQ(h5_numbers(scene.in(a, "series.h5"), name),
              h5_numbers(scene.in(b, "series.h5"), name))
        << name;
  }
}

TEST(Simulate, WritesOneMeshPerBodyAndASeries) {
  const SimulateScene scene;

  const CommandResult result = scene.simulate({"-o", "out"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  Names names;
  for (const auto& entry : fs::directory_iterator(scene.path() / "out")) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names,
            (Names{"ball.surface.vtkhdf", "ball.vtkhdf", "beam.surface.vtkhdf", "beam.vtkhdf",
                   "fruit.surface.vtkhdf", "fruit.vtkhdf", "report.json", "series.h5"}));
  EXPECT_EQ(h5_numbers(scene.in("out", "series.h5"), "time").size(), 13u);
  EXPECT_EQ(h5_numbers(scene.in("out", "beam.vtkhdf"), "VTKHDF/Steps/Values"),
            (std::vector<double>{0, 5 * 0.01, 10 * 0.01, 12 * 0.01}));
  const auto report = nlohmann::json::parse(text_of(scene.in("out", "report.json")));
  EXPECT_EQ(report["status"], "done");
  EXPECT_EQ(report["frames"], 4);
  EXPECT_NEAR(report["bodies"]["beam"]["mass"].get<double>(), 4, 1e-9);
}

TEST(Simulate, CountsCellsThatAreThereTwiceOnceAndSaysSo) {
  const SimulateScene scene;
  write_mesh(scene / "twice.vtkhdf",
             {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}, {1, 0, 3, 2}}});
  write_text(scene / "twice.json", R"({"tetwarp_scene": 1, "time_step": 0.01, "duration": 0.01,
    "bodies": [{"name": "b", "kind": "fem", "mesh": {"file": "twice.vtkhdf"},
                "material": {"E": 1e6, "nu": 0.3, "density": 6000}}]})");

  const CommandResult result = run_command(scene, {"simulate", "twice.json", "-o", "out"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("twice.vtkhdf: 1 of 2 cells are there twice and were merged"),
            std::string::npos)
      << result.err;
  const auto report = nlohmann::json::parse(text_of(scene.in("out", "report.json")));
  EXPECT_NEAR(report["bodies"]["b"]["mass"].get<double>(), 1000, 1e-9);
  EXPECT_EQ(report["warnings"].size(), 1u);
}

TEST(Simulate, WritesMeshesThatWarpReads) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "out"}).exit_code, 0);

  const MeshReader mesh(scene.in("out", "fruit.vtkhdf"));

  EXPECT_EQ(mesh.header().times.size(), 4u);
  const Point3 rest = mesh.mesh().rest_positions.front();
  const Point3 start = mesh.read_step(0).front();
  EXPECT_NEAR(start[0] - rest[0], 1, 1e-12);
  EXPECT_NEAR(mesh.read_step(1).front()[1] - start[1], 0.05, 1e-9);
}

TEST(Simulate, GivesTheSameNumbersForAnyThreadCount) {
  const SimulateScene scene;

  ASSERT_EQ(scene.simulate({"-o", "one", "--threads", "1"}).exit_code, 0);
  ASSERT_EQ(scene.simulate({"-o", "three", "--threads", "3"}).exit_code, 0);

  expect_equal_results(scene, "one", "three");
}

/// The first run ends at step 7, whose frame the second one replaces by that of step 10.
TEST(Simulate, GoesOnFromACheckpointBitForBit) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "whole"}).exit_code, 0);
  ASSERT_EQ(scene.simulate({"-o", "parts", "--steps", "7", "--checkpoint", "state"}).exit_code, 0);
  EXPECT_EQ(h5_numbers(scene.in("parts", "series.h5"), "time").size(), 8u);

  const CommandResult result = scene.simulate({"-o", "parts", "--restart", "state"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  expect_equal_results(scene, "whole", "parts");
}

/// The state of step 4 takes the place of the later steps of the run that wrote it.
TEST(Simulate, ReplacesWhatIsBehindTheCheckpoint) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "out", "--steps", "4", "--checkpoint", "state"}).exit_code, 0);
  ASSERT_EQ(scene.simulate({"-o", "whole"}).exit_code, 0);
  ASSERT_EQ(scene.simulate({"-o", "out"}).exit_code, 0);

  ASSERT_EQ(scene.simulate({"-o", "out", "--restart", "state"}).exit_code, 0);

  expect_equal_results(scene, "whole", "out");
}

TEST(Simulate, StartsANewFolderAtTheCheckpoint) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "first", "--steps", "6", "--checkpoint", "state"}).exit_code, 0);

  ASSERT_EQ(scene.simulate({"-o", "second", "--restart", "state"}).exit_code, 0);

  const auto times = h5_numbers(scene.in("second", "series.h5"), "time");
  ASSERT_EQ(times.size(), 7u);
  EXPECT_EQ(times.front(), 6 * 0.01);
  EXPECT_EQ(h5_numbers(scene.in("second", "beam.vtkhdf"), "VTKHDF/Steps/Values"),
            (std::vector<double>{10 * 0.01, 12 * 0.01}));
}

TEST(Simulate, WarpsTheVolumesOfBodiesAtEveryFrame) {
  const SimulateScene scene;

  const CommandResult result =
      scene.simulate({"-o", "out", "--warp", "fruit", "--background", "-1"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  double total[2] = {0, 0};
  for (const int frame : {0, 3}) {
    const std::string name = "fruit.warped_000" + std::to_string(frame) + ".vtkhdf";
    const Volume warped = read_volume(scene.in("out", name));
    EXPECT_NEAR(warped.grid.spacing[0], 0.01, 1e-15);
    for (const float sample : warped.samples<float>()) total[frame / 3] += std::max(sample, 0.0f);
  }
  EXPECT_GT(total[0], 0);
  EXPECT_NEAR(total[1] / total[0], 1, 0.05);
  EXPECT_FALSE(fs::exists(scene.in("out", "fruit.warped_0004.vtkhdf")));
}

TEST(Simulate, DrawsPictures) {
  const SimulateScene scene;

  const CommandResult result =
      scene.simulate({"-o", "out", "--picture", "--pixels", "120,80", "--steps", "5"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(text_of(scene.in("out", "scene_0001.png")).starts_with("\x89PNG"));
  EXPECT_FALSE(fs::exists(scene.in("out", "scene_0002.png")));
  EXPECT_EQ(result.err, "");

  // The numbers in names that the user gives are not those of frames.
  write_text(scene.in("out", "run_0001.vtkhdf"), "");
  const CommandResult shorter = scene.simulate({"-o", "out", "--picture", "--pixels", "120,80",
                                                "--steps", "0", "--contacts", "out/run_12.vtkhdf"});
  ASSERT_EQ(shorter.exit_code, 0) << shorter.err;
  const auto report = nlohmann::json::parse(text_of(scene.in("out", "report.json")));
  const std::string warnings = report["warnings"].dump();
  EXPECT_NE(warnings.find("scene_0001.png: is of an earlier run"), std::string::npos) << warnings;
  EXPECT_EQ(warnings.find("run_0001.vtkhdf"), std::string::npos) << warnings;
}

/// A camera of the scene by its name shows what the same camera by its numbers shows.
TEST(Simulate, DrawsFromACameraOfTheScene) {
  const SimulateScene scene;
  std::string text = text_of(scene / "scene.json");
  text.insert(text.rfind('}'), R"(, "cameras": [
    {"name": "side", "eye": [3, 0.2, 0.5], "target": [0.1, 0, 0]},
    {"name": "narrow", "eye": [3, 0.2, 0.5], "target": [0.1, 0, 0], "angle": 0.1}])");
  write_text(scene / "scene.json", text);
  const auto picture = [&](const std::string& folder, Names words) {
    words.insert(words.end(), {"-o", folder, "--picture", "--pixels", "60,40", "--steps", "0"});
    const CommandResult result = scene.simulate(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return text_of(scene.in(folder, "scene_0000.png"));
  };

  const std::string side = picture("side", {"--camera", "side"});
  EXPECT_EQ(side, picture("same", {"--camera", "3,0.2,0.5,0.1,0,0"}));
  EXPECT_NE(side, picture("narrow", {"--camera", "narrow"}));
  EXPECT_NE(side, picture("usual", {}));
  const CommandResult missing = scene.simulate({"-o", "out", "--picture", "--camera", "front"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find(
                "--camera: the scene has no camera 'front'; give one of side, narrow, or six "
                "numbers"),
            std::string::npos)
      << missing.err;
  EXPECT_FALSE(fs::exists(scene.in("out", "series.h5")));
}

TEST(Simulate, WritesAFilmOrNamesThePackageThatItNeeds) {
  const SimulateScene scene;

  const CommandResult result = scene.simulate(
      {"-o", "out", "--film", "film.gif", "--pixels", "120,80", "--camera", "2,-3,1,0,0,0"});

  if (result.exit_code == 0) {
    EXPECT_TRUE(text_of(scene / "film.gif").starts_with("GIF89a"));
  } else {
    EXPECT_NE(result.err.find("libgif-dev"), std::string::npos) << result.err;
    EXPECT_EQ(scene.names(), (Names{"scene.json"}));
  }
}

}  // namespace
}  // namespace tetwarp::test
