/// @file test_cli_rules.cpp
/// Intensity, vectors, tensors and averages by the command.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
/// A folder with the ramp, a flow along x everywhere, and a box that shrinks x to a quarter and
/// turns it to y.
class TurnedScene : public TemporaryFolder {
 public:
  TurnedScene() {
    const Volume ramp = ramp_volume<float>();
    Volume flow = make_volume(ramp.grid, PixelType::float32, 3, "flow");
    for (std::size_t v = 0; v < flow.samples<float>().size(); v += 3) {
      flow.samples<float>()[v] = 1;
    }
    write_volumes(*this / "volume.vtkhdf", {&ramp, &flow});
    std::vector<Point3> moves;
    for (const Point3& p : box_mesh().rest_positions) {
      const Point3 to = {16 - (p[1] - 6), 6 + (p[0] - 16) / 4, p[2]};
      moves.push_back({to[0] - p[0], to[1] - p[1], 0});
    }
    write_mesh(*this / "mesh.vtkhdf", box_mesh(), {moves}, {0});
  }

  /// The flow at the center of the grid after a warp with more words.
  std::vector<float> flow_after(std::vector<std::string> words) const {
    words.insert(words.begin(), {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"});
    const CommandResult result = run_command(*this, words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Volume volume = read_volume(*this / "out.vtkhdf", "flow");
    const auto samples = volume.samples<float>();
    const std::size_t center = 3 * ((4 * 10 + 4) * 12 + 5);
    return {samples.begin() + center, samples.begin() + center + 3};
  }
};

TEST(CliRules, TurnVectorsByTheNamedLaw) {
  const TurnedScene scene;
  const auto expect_flow = [&](const std::vector<std::string>& words, float x, float y) {
    const std::vector<float> flow = scene.flow_after(words);
    EXPECT_NEAR(flow[0], x, 1e-5);
    EXPECT_NEAR(flow[1], y, 1e-5);
  };
  expect_flow({}, 1, 0);
  expect_flow({"--vectors", "flow"}, 0, 1);
  expect_flow({"--vectors", "flow=contravariant"}, 0, 0.25f);
  expect_flow({"--vectors=flow=covariant", "--intensity", "density"}, 0, 16);
}

/// Options in a job of a batch; and an output of other options is not up to date.
TEST(CliRules, AverageInABatchAndResumeOnlyWhatIsTheSame) {
  const TurnedScene scene;
  scene.flow_after({"--antialias"});
  write_text(scene / "jobs.json", R"({"jobs": [{"volume": "volume.vtkhdf", "mesh": "mesh.vtkhdf",
      "output": "out.vtkhdf", "antialias": true, "vectors": ["flow=covariant"],
      "resume": true, "report": "report.json"}]})");
  const std::vector<std::string> status = {"done", "skipped"};
  for (const std::string& expected : status) {
    const CommandResult result = run_command(scene, {"warp", "--batch", "jobs.json"});

    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
    EXPECT_EQ(report["status"], expected);
    EXPECT_EQ(report["counts"]["tets_averaged"], expected == "done" ? 5 : 0);
  }
}

TEST(CliRules, ReportTotalsOfWhatIsKept) {
  const TurnedScene scene;
  const auto total = [&](const std::string& intensity) {
    scene.flow_after({"--intensity", intensity, "--report", "report.json"});
    const auto step = nlohmann::json::parse(text_of(scene / "report.json"))["steps"][0];
    EXPECT_EQ(step["total_before"].size(), 4u);  // the ramp, and the three components of the flow
    return std::pair(step["total_before"][1].get<double>(), step["total_after"][1].get<double>());
  };

  const auto [before, after] = total("conservative");

  EXPECT_NEAR(before, 24 * 20 * 16, 1e-9);  // a flow of one over the box, which is the grid
  EXPECT_NEAR(after, before, 1e-5 * before);
  EXPECT_NE(total("density").second, after);
}
/// A volume of 8 bits at its upper limit, shrunk by four: the total cannot be kept.
TEST(CliRules, TellWhatStoringIntegersChanges) {
  const TurnedScene scene;
  Volume full = make_volume(ramp_volume<float>().grid, PixelType::uint8, 1, "full");
  std::ranges::fill(full.samples<std::uint8_t>(), std::uint8_t{255});
  write_volumes(scene / "full.vtkhdf", {&full});
  const auto warp = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"warp", "full.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"});
    return run_command(scene, words);
  };

  const CommandResult result = warp({"--intensity", "conservative", "--report", "report.json"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
  const auto& step = report["steps"][0];
  EXPECT_GT(step["counts"]["values_clipped"], 100);
  EXPECT_LT(step["total_relative_change"][0], -0.5);
  EXPECT_NEAR(step["total_after"][0].get<double>() - step["total_clipping"][0].get<double>() -
                  step["total_rounding"][0].get<double>(),
              step["total_before"][0].get<double>(), 1e-6);
  EXPECT_NE(result.err.find("conservative: rounding to integers changed the total by "),
            std::string::npos)
      << result.err;
  const std::string clipped = step["counts"]["values_clipped"].dump();
  EXPECT_NE(result.err.find(clipped + " values beyond the limits of the pixel type"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(warp({"--intensity", "conservative", "--quiet"}).err, "");
  EXPECT_EQ(warp({}).err.find("total"), std::string::npos);
}

/// Labels of floats are whole numbers: the same as labels of integers.
TEST(CliRules, LabelsOfFloatsAreThoseOfIntegers) {
  const Scene scene;
  Volume whole = ramp_volume<std::int16_t>("labels"), floats = ramp_volume<float>("labels");
  for (std::size_t v = 0; v < 960; ++v) {
    whole.samples<std::int16_t>()[v] = static_cast<std::int16_t>(v / 7 % 5);
    floats.samples<float>()[v] = static_cast<float>(v / 7 % 5);
  }
  write_volumes(scene / "whole.vtkhdf", {&whole});
  write_volumes(scene / "floats.vtkhdf", {&floats});
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({0.4}));
  const auto warp = [&](const std::string& name) {
    return run_command(scene, {"warp", name + ".vtkhdf", "mesh.vtkhdf", "-o", name + "_out.vtkhdf",
                               "--filter", "labels"});
  };

  EXPECT_EQ(warp("whole").exit_code, 0);
  const CommandResult result = warp("floats");

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("labels of float32 are written as int32"), std::string::npos);
  const Volume a = read_volume(scene / "whole_out.vtkhdf"),
               b = read_volume(scene / "floats_out.vtkhdf");
  ASSERT_EQ(b.type, PixelType::int32);
  for (std::size_t v = 0; v < 960; ++v) {
    ASSERT_EQ(a.samples<std::int16_t>()[v], b.samples<std::int32_t>()[v]) << v;
  }
  floats.samples<float>()[100] = 0.5F;
  write_volumes(scene / "floats.vtkhdf", {&floats});
  EXPECT_NE(warp("floats").err.find("holds 0.500000, which is no label"), std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test
