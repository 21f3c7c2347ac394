/// @file test_cli_certify.cpp
/// `tetwarp certify`: verdicts, exit codes and reports for files of two states and of many.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <tetwarp/scene_io.hpp>
#include <utility>
#include <vector>

#include "io/vtkhdf/simulation_mesh.hpp"
#include "tests/support/run_command.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

const Surface plate{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}};

/// A triangle above the plate at height z; its lowest point is first.
Surface needle(double z, double x = 1) {
  return {{{x, 1, z}, {x, 1, z + 1}, {x + 0.5, 1, z + 1}}, {{0, 1, 2}}};
}

/// A file as a simulation writes it: the first state, and displacements of each step.
void write_series(const std::string& path, const std::vector<Surface>& steps) {
  StepMeshWriter writer(path, steps.front(), {{.name = "displacement", .components = 3}});
  for (std::size_t s = 0; s < steps.size(); ++s) {
    std::vector<double> ways;
    for (std::size_t p = 0; p < steps[s].points.size(); ++p) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ways.push_back(steps[s].points[p][axis] - steps.front().points[p][axis]);
      }
    }
    const std::span<const double> values = ways;
    writer.append(static_cast<double>(s), {&values, 1});
  }
  writer.flush();
}

class CliCertify : public ::testing::Test {
 protected:
  CliCertify() {
    write_surface(folder / "plate.vtkhdf", plate);
    write_surface(folder / "high.vtkhdf", needle(1));
    write_surface(folder / "low.vtkhdf", needle(-3));
    write_surface(folder / "aside.vtkhdf", needle(1, 10));
  }
  CommandResult run(Names words) const {
    words.insert(words.begin(), "certify");
    return run_command(folder, words);
  }
  nlohmann::json report() const { return nlohmann::json::parse(text_of(folder / "report.json")); }

  const TemporaryFolder folder;
};

TEST_F(CliCertify, OfAMotionThroughAPlateTellsPairAndTime) {
  const CommandResult result = run({"plate.vtkhdf", "high.vtkhdf", "--to", "plate.vtkhdf",
                                    "low.vtkhdf", "--report", "report.json"});

  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(result.has_one_line_error());
  EXPECT_NE(result.err.find("triangle 0 of plate.vtkhdf and triangle 0 of high.vtkhdf meet at time "
                            "0.25"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(result.out, "meets, 1 near pairs of triangles\n");
  const nlohmann::json json = report();
  EXPECT_EQ(json["verdict"], "meets");
  const nlohmann::json& pair = json["steps"][0]["pairs"][0];
  EXPECT_EQ(pair["surfaces"], (std::vector{0, 1}));
  EXPECT_EQ(pair["verdict"], "meets");
  EXPECT_LE(pair["from"].get<double>(), 0.25);
  EXPECT_GE(pair["until"].get<double>(), 0.25);
}

TEST_F(CliCertify, OfSurfacesThatStayApartIsFree) {
  const CommandResult result = run({"plate.vtkhdf", "aside.vtkhdf", "--to", "plate.vtkhdf",
                                    "aside.vtkhdf", "--report", "report.json", "--quiet"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out + result.err, "");
  EXPECT_EQ(report()["verdict"], "free");
  EXPECT_TRUE(report()["steps"][0]["pairs"].empty());
}

/// One part of time does not suffice to find the meeting.
TEST_F(CliCertify, WithinALimitOfIntervalsIsUndecided) {
  const CommandResult result = run({"plate.vtkhdf", "high.vtkhdf", "--to", "plate.vtkhdf",
                                    "low.vtkhdf", "--max-intervals", "1"});

  EXPECT_EQ(result.exit_code, 4) << result.err;
  EXPECT_NE(result.err.find("may touch"), std::string::npos) << result.err;
}

TEST_F(CliCertify, OfSeriesExaminesEachMotionAndTakesObstaclesAtRest) {
  write_series(folder / "needle.vtkhdf", {needle(3), needle(2), needle(-2), needle(-3)});

  const CommandResult all = run({"needle.vtkhdf", "plate.vtkhdf", "--report", "report.json"});
  const nlohmann::json steps = report()["steps"];
  const CommandResult first = run({"needle.vtkhdf", "plate.vtkhdf", "--steps", "0:2"});
  const CommandResult ends = run({"needle.vtkhdf", "plate.vtkhdf", "--steps", "0,3"});

  EXPECT_EQ(all.exit_code, 3);
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0]["verdict"], "free");
  EXPECT_EQ(steps[1]["verdict"], "meets");
  EXPECT_EQ(steps[2]["verdict"], "free");
  EXPECT_EQ(steps[1]["from_step"], 1);
  EXPECT_EQ(steps[1]["to_step"], 2);
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(ends.exit_code, 3);
  EXPECT_EQ(run({"needle.vtkhdf", "plate.vtkhdf", "--steps", "1"}).exit_code, 1);
}

TEST_F(CliCertify, SeesTrianglesThatAreThereTwice) {
  Surface twice = needle(1);
  const Surface copy = needle(1);
  twice.points.insert(twice.points.end(), copy.points.begin(), copy.points.end());
  twice.triangles.push_back({3, 4, 5});
  write_surface(folder / "twice.vtkhdf", twice);
  const Names words{"twice.vtkhdf", "--to", "twice.vtkhdf"};

  EXPECT_EQ(run(words).exit_code, 3);
  EXPECT_EQ(run({"twice.vtkhdf", "--to", "twice.vtkhdf", "--no-self"}).exit_code, 0);
}

TEST_F(CliCertify, RefusesWhatDoesNotBelongTogether) {
  write_series(folder / "series.vtkhdf", {needle(3), needle(2)});
  write_series(folder / "long.vtkhdf", {needle(3), needle(2), needle(1)});
  Surface other = needle(1);
  other.triangles = {{0, 2, 1}};
  write_surface(folder / "other.vtkhdf", other);
  write_text(folder / "text.stl", "not a surface");
  const std::vector<std::pair<Names, std::string>> cases{
      {{"high.vtkhdf"}, "high.vtkhdf: holds one state"},
      {{"high.vtkhdf", "--to", "other.vtkhdf"}, "other.vtkhdf: has other triangles than high"},
      {{"high.vtkhdf", "--to", "series.vtkhdf"}, "series.vtkhdf: has 2 steps; leave out --to"},
      {{"series.vtkhdf", "long.vtkhdf"}, "long.vtkhdf: has 3 steps, but series.vtkhdf has 2"},
      {{"none.vtkhdf", "--to", "high.vtkhdf"}, "none.vtkhdf"},
      {{"text.stl", "--to", "text.stl"}, "text.stl"}};
  for (const auto& [words, message] : cases) {
    Names all = words;
    all.insert(all.end(), {"--report", "report.json"});
    const CommandResult result = run(all);
    EXPECT_EQ(result.exit_code, 1) << words[0];
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(folder / "report.json"));
  }
  EXPECT_EQ(run({"high.vtkhdf", "low.vtkhdf", "--to", "high.vtkhdf"}).exit_code, 2);
  EXPECT_EQ(run({"series.vtkhdf", "--to", "series.vtkhdf", "--steps", "0:2"}).exit_code, 2);
}
}  // namespace
}  // namespace tetwarp::test
