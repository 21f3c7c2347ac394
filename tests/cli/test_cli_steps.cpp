/// @file test_cli_steps.cpp
/// Displacement fields and rest meshes with several steps: the step is chosen, never guessed.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <tetwarp/io.hpp>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

class CliSteps : public ::testing::Test {
 protected:
  CommandResult run(const Names& words, int exit_code = 0) const {
    CommandResult result = run_command(scene, words);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_TRUE(exit_code == 0 || result.has_one_line_error()) << result.err;
    return result;
  }
  void expect_same(const std::string& a, const std::string& b, const std::string& array) const {
    const Volume first = read_volume(scene / a, array), second = read_volume(scene / b, array);
    const auto x = first.samples<float>(), y = second.samples<float>();
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t n = 0; n < x.size(); ++n) ASSERT_NEAR(x[n], y[n], 1e-4) << a << " " << n;
  }

  const Scene scene;
};

/// Fields of the steps 0, 1, 1 and 3 voxels in one file of each format.
TEST_F(CliSteps, OfAFieldAreChosenOneByOne) {
  for (const std::string& name : Names{"all.vtkhdf", "all.nii", "all.nrrd", "all.mha"}) {
    run({"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", name, "--outputs", "displacement",
         "--temporal"});
    const std::string field =
        name == "all.vtkhdf" ? name : "all_displacement" + name.substr(name.find('.'));
    const std::string refused = run({"warp", "volume.vtkhdf", field, "-o", "one.vtkhdf"}, 1).err;
    EXPECT_NE(refused.find("holds 4 steps of a displacement field; choose one by --steps N"),
              std::string::npos)
        << refused;
    EXPECT_NE(run({"warp", "volume.vtkhdf", field, "-o", "one.vtkhdf", "--steps", "1:3"}, 1)
                  .err.find("--steps chooses 2 steps"),
              std::string::npos);
    run({"warp", "volume.vtkhdf", field, "-o", "one.vtkhdf", "--steps", "4"}, 1);
    run({"compose", field, "-o", "step.vtkhdf", "--like", "volume.vtkhdf"});
    for (const std::string step : {"0", "1", "3"}) {
      const std::string composed = "step_000" + step + ".vtkhdf";
      run({"warp", "volume.vtkhdf", field, "-o", "one.vtkhdf", "--steps", step});
      run({"compose", "mesh.vtkhdf", "-o", "mesh_field.vtkhdf", "--like", "volume.vtkhdf",
           "--steps", step});
      expect_same(composed, "mesh_field.vtkhdf", "tetwarp_displacement");
      run({"warp", "volume.vtkhdf", "mesh_field.vtkhdf", "-o", "by_mesh.vtkhdf"});
      expect_same("one.vtkhdf", "by_mesh.vtkhdf", "density");
    }
  }
}

TEST_F(CliSteps, OfATransformWithoutSeveralAreRefused) {
  run({"compose", "mesh.vtkhdf", "-o", "field.vtkhdf", "--like", "volume.vtkhdf", "--steps", "3"});
  EXPECT_NE(run({"warp", "volume.vtkhdf", "field.vtkhdf", "-o", "o.vtkhdf", "--steps", "0"}, 1)
                .err.find("--steps is for warps by a mesh"),
            std::string::npos);
}

TEST_F(CliSteps, OfAFieldAndOfAMeshAreComposedStepByStep) {
  run({"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "all.vtkhdf", "--outputs", "displacement",
       "--temporal"});
  run({"compose", "all.vtkhdf", "mesh.vtkhdf", "-o", "both.vtkhdf", "--like", "volume.vtkhdf"});
  run({"compose", "mesh.vtkhdf", "mesh.vtkhdf", "-o", "twice.vtkhdf", "--like", "volume.vtkhdf"});
  for (const std::string step : {"0", "1"}) {
    expect_same("both_000" + step + ".vtkhdf", "twice_000" + step + ".vtkhdf",
                "tetwarp_displacement");
  }
  write_mesh(scene / "two.vtkhdf", box_mesh(), shifts({0, 1}), {0, 1});
  run({"compose", "all.vtkhdf", "two.vtkhdf", "-o", "o.vtkhdf", "--like", "volume.vtkhdf"}, 1);
}

/// Two rest steps whose points are shifted by 1 and by 2 voxels from those of the mesh, as a
/// ParaView series.
TEST_F(CliSteps, OfARestMeshThatMovesAreChosen) {
  const auto write_vtk = [&](const std::string& name, double shift) {
    std::string text = "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\n";
    text += "POINTS 8 double\n";
    for (const Point3& x : box_mesh().rest_positions) {
      text += std::to_string(x[0] + shift) + " " + std::to_string(x[1]) + " " +
              std::to_string(x[2]) + "\n";
    }
    text += "CELLS 5 25\n";
    for (const auto& tet : box_mesh().tets) {
      text += "4";
      for (const std::int32_t node : tet) text += " " + std::to_string(node);
      text += "\n";
    }
    std::ofstream(scene / name) << text << "CELL_TYPES 5\n10 10 10 10 10\n";
  };
  write_vtk("still.vtk", 0);
  write_vtk("rest_0.vtk", 2);
  write_vtk("rest_1.vtk", 4);
  const Names warp{"warp",     "volume.vtkhdf", "still.vtk",    "-o",
                   "o.vtkhdf", "--outputs",     "displacement", "--rest"};
  const auto with = [&](const Names& more) {
    Names words = warp;
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };

  EXPECT_NE(run(with({"rest_*.vtk"}), 1).err.find("choose those of the rest by --rest-step N"),
            std::string::npos);
  run(with({"rest_*.vtk", "--rest-step", "2"}), 1);
  EXPECT_NE(run(with({"rest_0.vtk", "--rest-step", "1"}), 1).err.find("leave out --rest-step"),
            std::string::npos);
  for (const int step : {0, 1}) {
    run(with({"rest_*.vtk", "--rest-step", std::to_string(step)}));
    const Volume field = read_volume(scene / "o.vtkhdf", "tetwarp_displacement");
    EXPECT_NEAR(field.samples<float>()[0], 2.0 + 2.0 * step, 1e-4);
    run({"compose", "still.vtk", "-o", "f.vtkhdf", "--like", "volume.vtkhdf", "--rest",
         "rest_*.vtk", "--rest-step", std::to_string(step)});
    expect_same("f.vtkhdf", "o.vtkhdf", "tetwarp_displacement");
  }
}

/// The array of displacements is from the points of its own file.
TEST_F(CliSteps, ARestMeshBesideADisplacementHasItsPoints) {
  write_mesh(scene / "rest.vtkhdf", box_mesh());
  Mesh other = box_mesh();
  other.rest_positions[3][1] += 0.25;
  write_mesh(scene / "other.vtkhdf", other);
  const Names warp{"warp", "volume.vtkhdf", "mesh.vtkhdf", "--steps", "3", "-o"};
  const auto with = [&](const Names& more) {
    Names words = warp;
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };

  run(with({"a.vtkhdf"}));
  run(with({"b.vtkhdf", "--rest", "rest.vtkhdf"}));
  expect_same("a.vtkhdf", "b.vtkhdf", "density");
  EXPECT_NE(run(with({"c.vtkhdf", "--rest", "other.vtkhdf"}), 1)
                .err.find("which are not those of 'other.vtkhdf'; leave out --rest"),
            std::string::npos);
}

/// The numbers are those of all steps; integers of 64 bits are exact.
TEST_F(CliSteps, AreAllInTheStatisticsOfInfo) {
  using Json = nlohmann::json;
  Grid grid;
  grid.dims = {2, 2, 2};
  TemporalVolumeWriter writer(scene / "series.vtkhdf");
  for (int step = 0; step < 3; ++step) {
    Volume whole = make_volume(grid, PixelType::uint64, 1, "whole");
    whole.samples<std::uint64_t>()[step] = (std::uint64_t{1} << 63) + 1 + 2 * step;
    Volume real = make_volume(grid, PixelType::float32, 1, "real");
    real.samples<float>()[0] = static_cast<float>(step);
    real.samples<float>()[1] = std::numeric_limits<float>::quiet_NaN();
    writer.append(step, {&whole, &real});
  }
  writer.finish();

  const Json info = Json::parse(run({"info", "series.vtkhdf", "--stats", "--json"}).out);

  EXPECT_EQ(info["arrays"]["whole"]["max"].get<std::uint64_t>(), (std::uint64_t{1} << 63) + 5);
  EXPECT_EQ(info["arrays"]["whole"]["min"], 0);
  EXPECT_EQ(info["arrays"]["real"]["max"], 2.0);
  EXPECT_EQ(info["arrays"]["real"]["nan"], 3);
}
}  // namespace
}  // namespace tetwarp::test
