/// @file test_cli_simulate_volumes.cpp
/// Volumes that follow the bodies of the shipped scenes during `tetwarp simulate`, and rays through
/// them.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/scene_io.hpp>
#include <tetwarp/warp.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "host/base/point3.hpp"
#include "tests/support/simulate_scene.hpp"

namespace tetwarp::test {
namespace {
using Replacements = std::vector<std::pair<std::string, std::string>>;

/// Writes scene.json: a shipped scene with coarser volumes and surfaces.
void write_coarse(const TemporaryFolder& folder,
                  const std::string& name,
                  const Replacements& replacements) {
  std::string text = scene_text(name);
  for (const auto& [from, to] : replacements) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
      text.replace(at, from.size(), to);
    }
  }
  write_text(folder / "scene.json", text);
}

double total_of(const Volume& volume) {
  double sum = 0;
  const auto add = [&](auto samples) {
    sum = std::accumulate(samples.begin(), samples.end(), sum);
  };
  if (volume.type == PixelType::uint8) {
    add(volume.samples<std::uint8_t>());
  } else {
    add(volume.samples<float>());
  }
  const Point3& spacing = volume.grid.spacing;
  return sum * spacing[0] * spacing[1] * spacing[2];
}

double volume_of_mesh(const Mesh& mesh, const std::vector<Point3>& nodes) {
  double sum = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    sum += tet_volume(nodes[static_cast<std::size_t>(a)], nodes[static_cast<std::size_t>(b)],
                      nodes[static_cast<std::size_t>(c)], nodes[static_cast<std::size_t>(d)]);
  }
  return sum;
}

/// Half a voxel at both ends of a box around nodes, as a share of its volume.
double half_voxels(const Grid& grid, const std::vector<Point3>& nodes) {
  Bounds box;
  for (const Point3& node : nodes) box.include(node);
  double sum = 0;
  for (std::size_t d = 0; d < 3; ++d) sum += grid.spacing[d] / (box.high[d] - box.low[d]);
  return sum;
}

/// At every frame of a run the sum of densities of all volumes is that of the part of the source
/// in the lattice to `bound`, the mask has the volume of the tetrahedra up to half a voxel on
/// all sides and, unless samples are averaged, nothing lies outside of it. The lattice has all but
/// 3 % of the source: samples below the threshold may be outside.
void expect_kept_totals(const TemporaryFolder& folder,
                        const std::vector<std::string>& options,
                        double bound) {
  std::vector<std::string> words{"simulate", "scene.json", "-o",        "out",
                                 "--quiet",  "--warp",     "--outputs", "mask"};
  words.insert(words.end(), options.begin(), options.end());
  const CommandResult run = run_command(folder, words);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const Body& body : read_scene(folder / "scene.json").bodies) {
    const MeshReader reader((folder.path() / "out" / (body.name + ".vtkhdf")).string());
    const Mesh mesh = reader.mesh();
    const Volume& source = std::get<ImageGeometry>(body.geometry).volume;
    const double total = total_of(warp(source, mesh, mesh.rest_positions).volume);
    EXPECT_NEAR(total / total_of(source), 1, 0.03);
    const auto frames = static_cast<std::int64_t>(reader.header().times.size());
    EXPECT_GE(frames, 4);
    for (std::int64_t frame = 0; frame < frames; ++frame) {
      const std::string name = body.name + ".warped_000" + std::to_string(frame) + ".vtkhdf";
      const std::string path = (folder.path() / "out" / name).string();
      const Volume mask = read_volume(path, "tetwarp_mask");
      const std::vector<Point3> nodes = reader.read_step(frame);
      const double filled = volume_of_mesh(mesh, nodes);
      EXPECT_NEAR(total_of(mask) / filled, 1, half_voxels(mask.grid, nodes)) << name;
      const Volume warped = read_volume(path);
      EXPECT_NEAR(total_of(warped) / total, 1, bound) << name;
      double outside = 0;
      for (std::size_t v = 0; v < mask.data.size(); ++v) {
        if (mask.samples<std::uint8_t>()[v] != 0) continue;
        outside += warped.type == PixelType::uint8 ? warped.samples<std::uint8_t>()[v]
                                                   : std::abs(warped.samples<float>()[v]);
      }
      if (bound > 1e-3) {
        EXPECT_EQ(outside, 0) << name;
      }
    }
  }
}

const Replacements coarse_torso{{"[256, 160, 122]", "[64, 40, 30]"},
                                {"[0.0015, 0.0015, 0.0015]", "[0.006, 0.006, 0.006]"},
                                {"\"triangles\": 20000", "\"triangles\": 2000"}};
const Replacements coarse_oranges{{"[198, 199, 160]", "[50, 50, 40]"},
                                  {"[0.0004, 0.0004, 0.0005]", "[0.0016, 0.0016, 0.002]"},
                                  {"\"triangles\": 3200", "\"triangles\": 400"}};
const Replacements coarse_carps{{"[204, 202, 512]", "[26, 26, 64]"},
                                {"[0.001, 0.001, 0.001]", "[0.008, 0.008, 0.008]"},
                                {"\"triangles\": 4000", "\"triangles\": 500"}};

TEST(SimulatedVolumes, TheTorsoKeepsItsTotal) {
  const TemporaryFolder folder;
  write_coarse(folder, "torso", coarse_torso);
  expect_kept_totals(folder, {"--steps", "50", "--intensity", "density"}, 0.01);
}

TEST(SimulatedVolumes, OrangesKeepTheirTotals) {
  const TemporaryFolder folder;
  write_coarse(folder, "oranges", coarse_oranges);
  expect_kept_totals(folder, {"--steps", "100", "--intensity", "density"}, 0.01);
}

TEST(SimulatedVolumes, CarpsKeepTheirTotals) {
  const TemporaryFolder folder;
  write_coarse(folder, "carps", coarse_carps);
  expect_kept_totals(folder, {"--steps", "10", "--intensity", "density"}, 0.01);
}

TEST(SimulatedVolumes, KeepTotalsToRoundingWhereTheyAreAveraged) {
  const TemporaryFolder folder;
  write_coarse(folder, "torso", coarse_torso);
  expect_kept_totals(folder, {"--steps", "30", "--intensity", "conservative"}, 1e-5);
}

TEST(SimulatedVolumes, AreDrawnByRaysWithoutFilesOfThem) {
  const SimulateScene scene;

  const CommandResult surfaces =
      scene.simulate({"-o", "plain", "--steps", "5", "--picture", "--pixels", "60,40"});
  const CommandResult rays = scene.simulate(
      {"-o", "rays", "--steps", "5", "--picture", "--pixels", "60,40", "--cast", "mr"});

  ASSERT_EQ(surfaces.exit_code, 0) << surfaces.err;
  ASSERT_EQ(rays.exit_code, 0) << rays.err;
  EXPECT_NE(text_of(scene.in("plain", "scene_0001.png")),
            text_of(scene.in("rays", "scene_0001.png")));
  EXPECT_FALSE(fs::exists(scene.in("rays", "fruit.warped_0000.vtkhdf")));
}

TEST(SimulatedVolumes, NameWhatIsWrongInOneLine) {
  const SimulateScene scene;
  write_text(scene / "colors.json",
             R"({"points": [{"value": 0, "color": [0, 0, 2], "opacity": 0}]})");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--cast"}, "needs --picture or --film"},
      {{"--pixels", "60,40"}, "--pixels: needs --picture or --film"},
      {{"--like-series", "1.2"}, "--like-series: needs --warp or --cast"},
      {{"--picture", "--cast", "--spacing", "1e-15,1e-15,1e-15"}, ": --cast: output grid"},
      {{"--outputs", "mask"}, "needs --warp"},
      {{"--warp", "--outputs", "forward"}, "--grid same"},
      {{"--picture", "--cast", "colors.json"}, "points[0].color"},
      {{"--picture", "--cast", "missing.json"}, "missing.json"}};
  for (const auto& [options, named] : cases) {
    std::vector<std::string> words{"-o", "out"};
    words.insert(words.end(), options.begin(), options.end());

    const CommandResult result = scene.simulate(words);

    EXPECT_NE(result.exit_code, 0) << named;
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find(named), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(scene / "out")) << named;
  }
}

}  // namespace
}  // namespace tetwarp::test
