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
  for (const Words& more :
       {Words{"--antialias"}, Words{"--intensity", "density"}, Words{"--outputs", "forward"}}) {
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

/// A quadratic motion of tetrahedra of ten nodes within 24^3 voxels: one map of all cells.
class CliQuadratic : public ::testing::Test {
 protected:
  CliQuadratic() : mesh(with_mid_nodes(scenes::lattice({3, 3, 3}, {2, 2, 2}, {20, 20, 20}))) {
    const Volume volume = scenes::wavy_volume(scenes::unit_grid(24, 24, 24), PixelType::float32);
    write_volumes(folder / "volume.vtkhdf", {&volume});
    std::vector<Point3> displacement;
    for (const Point3& x : mesh.mesh.rest_positions) {
      deformed.push_back(quadratic(x));
      const Point3& y = deformed.back();
      displacement.push_back({y[0] - x[0], y[1] - x[1], y[2] - x[2]});
    }
    write_mesh(folder / "ten.vtkhdf", mesh, {displacement});
  }

  CommandResult run(const Words& words) const {
    const CommandResult result = run_command(folder, words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result;
  }

  /// Where the field of a file takes the voxels, and which ones it moves.
  struct Positions {
    std::vector<Point3> voxels, places;
    std::size_t moved = 0;
  };
  Positions field_of(const std::string& name) const {
    const Volume field = read_volume(folder / name);
    const auto numbers = field.samples<float>();
    Positions result;
    for (std::size_t v = 0; v < 24 * 24 * 24; ++v) {
      const Point3 x{static_cast<double>(v % 24), static_cast<double>(v / 24 % 24),
                     static_cast<double>(v / 24 / 24)};
      Point3 y = x;
      for (std::size_t axis = 0; axis < 3; ++axis) y[axis] += numbers[3 * v + axis];
      result.voxels.push_back(x);
      result.places.push_back(y);
      result.moved += y != x;
    }
    return result;
  }

  static double distance(const Point3& a, const Point3& b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
  }

  const TemporaryFolder folder;
  CurvedMesh mesh;
  std::vector<Point3> deformed;
};

TEST_F(CliQuadratic, FieldsOfComposeAreTheClosedForm) {
  run({"compose", "ten.vtkhdf", "-o", "field.vtkhdf", "--like", "volume.vtkhdf"});
  run({"compose", "ten.vtkhdf", "-o", "split.vtkhdf", "--like", "volume.vtkhdf", "--ten-nodes",
       "split"});
  run({"compose", "ten.vtkhdf^-1", "ten.vtkhdf", "-o", "none.vtkhdf", "--like", "volume.vtkhdf"});

  const Positions curved = field_of("field.vtkhdf"), split = field_of("split.vtkhdf");
  double worst = 0, off = 0;
  for (std::size_t v = 0; v < curved.voxels.size(); ++v) {
    const Point3& x = curved.voxels[v];
    if (curved.places[v] != x) worst = std::max(worst, distance(quadratic(curved.places[v]), x));
    if (split.places[v] != x) off = std::max(off, distance(quadratic(split.places[v]), x));
  }
  EXPECT_LT(worst, 1e-5);  // of float32
  EXPECT_GT(off, 1e-2);
  EXPECT_GT(curved.moved, 3000U);
  const Positions none = field_of("none.vtkhdf");
  for (std::size_t v = 0; v < none.voxels.size(); ++v) {
    const auto [low, high] = std::ranges::minmax(curved.places[v]);
    if (curved.places[v] == curved.voxels[v] || low < 4 || high > 18) continue;  // near the hulls
    ASSERT_LT(distance(none.places[v], none.voxels[v]), 1e-6) << v;
  }
}

TEST_F(CliQuadratic, InvertExchangesPositionsAndKeepsTheCurves) {
  const CommandResult result = run({"invert", "ten.vtkhdf", "-o", "back.vtkhdf"});
  run({"invert", "back.vtkhdf", "-o", "again.vtkhdf", "--quiet"});

  const MeshReader back(folder / "back.vtkhdf", {.import = {.keeps_curved = true}});
  const MeshReader again(folder / "again.vtkhdf", {.import = {.keeps_curved = true}});
  EXPECT_EQ(back.mesh().rest_positions, deformed);
  EXPECT_EQ(back.mid_nodes(), mesh.mid_nodes);
  EXPECT_EQ(back.read_step(0), mesh.mesh.rest_positions);
  EXPECT_EQ(again.mesh().rest_positions, mesh.mesh.rest_positions);
  EXPECT_EQ(result.err, "");
  const std::string marker = " points within ";
  const std::size_t at = result.out.find(marker);
  ASSERT_NE(at, std::string::npos) << result.out;
  EXPECT_LT(std::stod(result.out.substr(at + marker.size())), 1e-9) << result.out;
  run({"compose", "ten.vtkhdf", "-o", "a.vtkhdf", "--like", "volume.vtkhdf"});
  run({"compose", "back.vtkhdf^-1", "-o", "b.vtkhdf", "--like", "volume.vtkhdf"});
  EXPECT_TRUE(read_volume(folder / "a.vtkhdf").data == read_volume(folder / "b.vtkhdf").data);
}

/// Cells bent in their own ways: places between a straight and a curved face come back by the
/// neighbor, and those of folded cells not at all.
TEST_F(CliCurved, InvertTellsWhatDoesNotComeBack) {
  const CommandResult gentle = run({"invert", "ten.vtkhdf", "-o", "back.vtkhdf", "--step", "1"});
  EXPECT_EQ(gentle.exit_code, 0) << gentle.err;
  EXPECT_EQ(gentle.err, "");
  EXPECT_NE(gentle.out.find(" at curved faces within "), std::string::npos) << gentle.out;

  std::vector<Point3> wild = shaken(mesh.mesh.rest_positions, 12, 5);
  for (std::size_t n = 0; n < wild.size(); ++n) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      wild[n][axis] = n < 8 ? 0 : wild[n][axis] - mesh.mesh.rest_positions[n][axis];
    }
  }
  write_mesh(scene / "wild.vtkhdf", mesh, {wild});
  const CommandResult folded = run({"invert", "wild.vtkhdf", "-o", "wild_back.vtkhdf"});
  EXPECT_EQ(folded.exit_code, 0) << folded.err;
  EXPECT_NE(folded.err.find(" points are mapped by the straight tetrahedron of their cell"),
            std::string::npos)
      << folded.err;
  EXPECT_EQ(folded.err.find("folds: "), std::string::npos) << "no cell maps to another's place";

  std::vector<Point3> crossed(wild.size(), Point3{0, 0, 0});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    crossed[0][axis] =
        1.5 * (mesh.mesh.rest_positions[7][axis] - mesh.mesh.rest_positions[0][axis]);
  }
  write_mesh(scene / "crossed.vtkhdf", mesh, {crossed});
  const CommandResult through = run({"invert", "crossed.vtkhdf", "-o", "crossed_back.vtkhdf"});
  EXPECT_EQ(through.exit_code, 0) << through.err;
  EXPECT_NE(through.err.find("folds: "), std::string::npos) << through.err;
  EXPECT_EQ(through.err.find("folds: 0 inverted"), std::string::npos) << through.err;
}

/// A pyramid of two curved tetrahedra on a hexahedron: what the bent diagonal moves into the
/// hexahedron, its middle and the centers of both faces, comes back by that, and nothing folds.
TEST_F(CliCurved, InvertCountsPlacesBesideHexahedra) {
  const Mesh pyramid{{{0, 0, 0},
                      {8, 0, 0},
                      {8, 8, 0},
                      {0, 8, 0},
                      {0, 0, 8},
                      {8, 0, 8},
                      {8, 8, 8},
                      {0, 8, 8},
                      {4, 4, 16}},
                     {{4, 5, 6, 8}, {4, 6, 7, 8}}};
  CurvedMesh both = with_mid_nodes(pyramid);
  both.mesh.hexes = {{0, 1, 2, 3, 4, 5, 6, 7}};
  const auto diagonal = static_cast<std::size_t>(both.mid_nodes[0][2]);
  for (const double bend : {-1.0, 1.0}) {
    std::vector<Point3> displacement(both.mesh.rest_positions.size(), Point3{0, 0, 0});
    displacement[diagonal][2] = bend;
    write_mesh(scene / "both.vtkhdf", both, {displacement});
    const CommandResult result = run({"invert", "both.vtkhdf", "-o", "back.vtkhdf"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(result.out.find(", of 3 at curved faces within 1:") != std::string::npos, bend < 0)
        << result.out;
    EXPECT_EQ(run({"invert", "back.vtkhdf", "-o", "again.vtkhdf"}).err, "");
  }
}

/// Tetrahedra of ten nodes and hexahedra in one file, whose points are the deformed ones.
TEST_F(CliCurved, WarpsBesideHexahedraWithRestPositionsOfAnotherFile) {
  const Volume source = read_volume(scene / "volume.vtkhdf");
  CurvedMesh both = mesh;
  std::vector<Point3> rest = mesh.mesh.rest_positions, now = steps[1];
  for (Point3& x : now) x[0] -= 9;
  const std::vector<Point3> now_of_tets = now;
  const auto first = static_cast<std::int32_t>(rest.size());
  for (std::size_t node = 0; node < 8; ++node) {
    const std::size_t corner = std::array<std::size_t, 8>{0, 1, 3, 2, 4, 5, 7, 6}[node];
    rest.push_back(box_mesh().rest_positions[corner]);
    now.push_back({rest.back()[0], rest.back()[1] + (node < 4 ? 2 : 3), rest.back()[2]});
  }
  both.mesh.hexes = {
      {first, first + 1, first + 2, first + 3, first + 4, first + 5, first + 6, first + 7}};
  both.mesh.rest_positions = rest;
  write_mesh(scene / "rest.vtkhdf", both);
  CurvedMesh moved = both;
  moved.mesh.rest_positions = now;
  write_mesh(scene / "now.vtkhdf", moved);

  const CommandResult result = run({"warp", "volume.vtkhdf", "now.vtkhdf", "--rest", "rest.vtkhdf",
                                    "-o", "out.vtkhdf", "--outputs", "tet"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Volume found = read_volume(scene / "out.vtkhdf", "density");
  const Volume owners = read_volume(scene / "out.vtkhdf", "tetwarp_tet");
  Warper tets(std::array{VolumeView(source)}, mesh);
  const Volume of_tets = tets.step(now_of_tets);
  const Volume of_hex = warp(source, Mesh{rest, {}, both.mesh.hexes}, now).volume;
  std::array<int, 2> counts{};
  for (std::size_t v = 0; v < owners.samples<std::int32_t>().size(); ++v) {
    const std::int32_t owner = owners.samples<std::int32_t>()[v];
    if (owner < 0) continue;
    const bool is_hex = owner == 5;
    ++counts[is_hex ? 1 : 0];
    ASSERT_EQ(found.samples<float>()[v], (is_hex ? of_hex : of_tets).samples<float>()[v]) << v;
  }
  EXPECT_GT(counts[0], 100);
  EXPECT_GT(counts[1], 50);
}

TEST_F(CliCurved, BatchesTakeTenNodesAsADefaultThatJobsOverride) {
  write_text(scene / "jobs.json",
             R"({"jobs": [{"volume": "volume.vtkhdf", "mesh": "ten.vtkhdf", "output": "a.vtkhdf"},
 {"volume": "volume.vtkhdf", "mesh": "ten.vtkhdf", "output": "b.vtkhdf", "ten-nodes": "curved"}]})");

  const CommandResult result =
      run({"warp", "--batch", "jobs.json", "--ten-nodes", "split", "--steps", "1"});

  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Volume source = read_volume(scene / "volume.vtkhdf");
  Warper curved(std::array{VolumeView(source)}, mesh);
  EXPECT_TRUE(read_volume(scene / "a.vtkhdf").data ==
              warp(source, split_curved(mesh), steps[1]).volume.data);
  EXPECT_TRUE(read_volume(scene / "b.vtkhdf").data == curved.step(steps[1]).data);
}

/// Both source and output, each of 13 MB, are read and written in blocks.
TEST_F(CliCurved, BlocksHaveTheBitsOfTheWhole) {
  if (has_address_sanitizer) GTEST_SKIP() << "the address sanitizer takes more memory";
  Grid grid = read_volume_header(scene / "volume.vtkhdf").grid;
  grid.spacing = {24.0 / 160, 20.0 / 150, 16.0 / 140};
  grid.dims = {160, 150, 140};
  const Volume volume = scenes::wavy_volume(grid, PixelType::float32);
  write_volumes(scene / "large.vtkhdf", {&volume});
  const Words words{"warp", "large.vtkhdf", "ten.vtkhdf", "--steps", "1", "--threads", "2", "-o"};
  Words whole = words, blocks = words;
  whole.insert(whole.end(), {"whole.vtkhdf", "--report", "whole.json"});
  blocks.insert(blocks.end(), {"blocks.vtkhdf", "--report", "blocks.json", "--memory", "58M"});
  Words plan = blocks;
  plan.push_back("--dry-run");

  const CommandResult planned = run(plan), in_memory = run(whole), in_blocks = run(blocks);

  EXPECT_NE(planned.out.find(" blocks of up to "), std::string::npos) << planned.out << planned.err;
  ASSERT_EQ(in_memory.exit_code, 0) << in_memory.err;
  ASSERT_EQ(in_blocks.exit_code, 0) << in_blocks.err;
  EXPECT_LE(in_blocks.peak_memory, 1.02 * 58 * (1 << 20));
  EXPECT_TRUE(read_volume(scene / "blocks.vtkhdf").data ==
              read_volume(scene / "whole.vtkhdf").data);
  const auto report = [&](const char* name) {
    return nlohmann::json::parse(text_of(scene / name)).at("counts");
  };
  EXPECT_EQ(report("blocks.json").at("covered"), report("whole.json").at("covered"));
}
}  // namespace
}  // namespace tetwarp::test
