/// @file test_cli_curved.cpp
/// Meshes of ten-node tetrahedra in files and in the commands that read meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/map_points.hpp>
#include <tetwarp/warp.hpp>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/curved_scenes.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
using Words = std::vector<std::string>;

/// The scene's box with nodes on its edges, which move by up to half a voxel in two steps; the
/// second tetrahedron has four nodes.
class CliCurved : public ::testing::Test {
 protected:
  CliCurved() : mesh(with_mid_nodes(box_mesh())) {
    mesh.mid_nodes[1] = no_mid_nodes;
    for (const std::uint64_t seed : {3U, 4U}) {
      steps.push_back(shaken(mesh.mesh.rest_positions, 1, seed));
      std::vector<Point3>& displacement = displacements.emplace_back();
      for (std::size_t n = 0; n < steps.back().size(); ++n) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          steps.back()[n][axis] = std::nearbyint(steps.back()[n][axis] * 64) / 64;
        }
        const Point3 &now = steps.back()[n], &rest = mesh.mesh.rest_positions[n];
        displacement.push_back({now[0] - rest[0], now[1] - rest[1], now[2] - rest[2]});
      }
    }
    write_mesh(scene / "ten.vtkhdf", mesh, displacements, {0, 1});
  }

  CommandResult run(const Words& words) const { return run_command(scene, words); }

  /// The first three columns of a file of points.
  std::vector<Point3> rows_of(const std::string& name) const {
    std::istringstream lines(text_of(scene / name));
    std::string line;
    std::getline(lines, line);  // names
    std::vector<Point3> points;
    while (std::getline(lines, line)) {
      std::ranges::replace(line, ',', ' ');
      std::istringstream numbers(line);
      Point3& point = points.emplace_back();
      numbers >> point[0] >> point[1] >> point[2];
    }
    return points;
  }

  const Scene scene;
  CurvedMesh mesh;
  std::vector<std::vector<Point3>> displacements, steps;
};

TEST_F(CliCurved, FilesKeepTheirNodesOrAreCut) {
  const MeshReader kept(scene / "ten.vtkhdf", {.import = {.keeps_curved = true}});
  const MeshReader cut(scene / "ten.vtkhdf");

  EXPECT_EQ(kept.mesh().tets, mesh.mesh.tets);
  EXPECT_EQ(kept.mid_nodes(), mesh.mid_nodes);
  EXPECT_EQ(kept.read_step(1), steps[1]);
  EXPECT_EQ(cut.mesh().tets, split_curved(mesh).tets);
  EXPECT_TRUE(cut.mid_nodes().empty());
  EXPECT_EQ(cut.header().tet_count, 4 * 8 + 1);
  EXPECT_EQ(cut.read_step(0), steps[0]);
}

TEST_F(CliCurved, WarpsAreThoseOfTheLibrary) {
  const Volume source = read_volume(scene / "volume.vtkhdf");
  const CommandResult result =
      run({"warp", "volume.vtkhdf", "ten.vtkhdf", "-o", "out.vtkhdf", "--temporal", "--outputs",
           "displacement", "--report", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  Warper warper(std::array{VolumeView(source)}, mesh);
  for (std::int64_t step = 0; step < 2; ++step) {
    const Volume warped = warper.step(steps[static_cast<std::size_t>(step)]);
    EXPECT_TRUE(read_volume(scene / "out.vtkhdf", "density", step).data == warped.data);
  }
  const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
  EXPECT_EQ(report.at("counts").at("voxels_straightened"), 0);

  const CommandResult cut = run({"warp", "volume.vtkhdf", "ten.vtkhdf", "-o", "cut.vtkhdf",
                                 "--ten-nodes", "split", "--steps", "1", "--intensity", "density"});
  ASSERT_EQ(cut.exit_code, 0) << cut.err;
  EXPECT_TRUE(
      read_volume(scene / "cut.vtkhdf").data ==
      warp(source, split_curved(mesh), steps[1], {.intensity = Intensity::density}).volume.data);
}

TEST_F(CliCurved, RefusesInOneLineWhatCurvesDoNotGive) {
  for (const Words& more : {Words{"--antialias"}, Words{"--intensity", "density"},
                            Words{"--outputs", "forward"}, Words{"--memory", "1M"}}) {
    Words words{"warp", "volume.vtkhdf", "ten.vtkhdf", "-o", "out.vtkhdf"};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run(words);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find("by --ten-nodes split"), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(scene / "out_0000.vtkhdf"));
  }
}

TEST_F(CliCurved, PointsFollowTheCurves) {
  write_text(scene / "a.csv", "x,y,z\n7,1,103\n20.5,10.25,110\n");
  const CommandResult result =
      run({"points", "a.csv", "ten.vtkhdf", "-o", "b.csv", "--steps", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto moved = map_points(mesh, steps[1], {{7, 1, 103}, {20.5, 10.25, 110}});
  const auto straight = map_points(mesh.mesh, steps[1], {{7, 1, 103}, {20.5, 10.25, 110}});
  const CommandResult back =
      run({"points", "b.csv", "ten.vtkhdf", "-o", "d.csv", "--steps", "1", "--inverse"});
  ASSERT_EQ(back.exit_code, 0) << back.err;

  const std::vector<Point3> forth = rows_of("b.csv"), again = rows_of("d.csv");
  ASSERT_EQ(forth.size(), 2U);
  ASSERT_EQ(again.size(), 2U);
  const std::vector<Point3> start = {{7, 1, 103}, {20.5, 10.25, 110}};
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(forth[p][axis], moved.points[p][axis], 1e-12);
      EXPECT_NEAR(again[p][axis], start[p][axis], 1e-6);
    }
  }
  EXPECT_GT(std::abs(moved.points[0][0] - straight.points[0][0]), 1e-3);
}

/// Cells of ten nodes stay what they are.
TEST_F(CliCurved, ImportKeepsTheCells) {
  write_text(scene / "a.vtk",
             "# vtk DataFile Version 3.0\nten\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n"
             "0 0 0 2 0 0 0 2 0 0 0 2 1 0 0.25 1 1 0 0 1 0 0 0 1 1 0 1 0 1 1\nCELLS 1 11\n"
             "10 0 1 2 3 4 5 6 7 8 9\nCELL_TYPES 1\n24\n");
  const CommandResult result = run({"import", "a.vtk", "-o", "a.vtkhdf"});
  if (result.err.find("libvtk9-dev") != std::string::npos) GTEST_SKIP() << result.err;
  ASSERT_EQ(result.exit_code, 0) << result.err;

  const MeshReader reader(scene / "a.vtkhdf", {.import = {.keeps_curved = true}});
  EXPECT_EQ(reader.mid_nodes(), (std::vector<MidNodes>{{4, 5, 6, 7, 8, 9}}));
  EXPECT_EQ(reader.mesh().rest_positions[4], (Point3{1, 0, 0.25}));
}
}  // namespace
}  // namespace tetwarp::test
