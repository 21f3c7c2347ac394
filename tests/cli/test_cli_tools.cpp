/// @file test_cli_tools.cpp
/// The commands around `tetwarp warp`: from a volume to meshes, deformations, pictures and back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

TEST(Cli, LeadsFromAVolumeToAPicture) {
  const TemporaryFolder folder;
  const Volume phantom = make_phantom({24, 16, 12});
  write_volumes(folder / "volume.vtkhdf", {&phantom});
  const std::vector<Names> commands{
      {"mesh", "volume.vtkhdf", "-o", "mesh.vtkhdf", "--cells", "3", "--threshold", "0.02"},
      {"deform", "mesh.vtkhdf", "-o", "moving.vtkhdf", "--kind", "bend", "--steps", "3", "--axis",
       "x", "--amount", "0.3"},
      {"warp", "volume.vtkhdf", "moving.vtkhdf", "-o", "out.vtkhdf", "--steps", "2"},
      {"render", "volume.vtkhdf", "--beside", "out.vtkhdf", "-o", "picture.png"},
      {"export", "out.vtkhdf", "-o", "out.nii.gz"},
      {"import", "out.nii.gz", "-o", "back.vtkhdf", "--compress", "1"}};

  for (const Names& command : commands) {
    const CommandResult result = run_command(folder, command);
    ASSERT_EQ(result.exit_code, 0) << command.front() << ": " << result.err;
  }

  EXPECT_EQ(read_volume(folder / "back.vtkhdf").data, read_volume(folder / "out.vtkhdf").data);
  EXPECT_GT(fs::file_size(folder / "picture.png"), 1000u);
  EXPECT_EQ(MeshReader(folder / "moving.vtkhdf").header().times, (std::vector<double>{0, 0.5, 1}));
}

TEST(Cli, QuietPrintsNothingOnEveryCommand) {
  const Scene scene;
  for (const Names& command : std::vector<Names>{
           {"mesh", "volume.vtkhdf", "-o", "lattice.vtkhdf", "--cells", "3"},
           {"deform", "lattice.vtkhdf", "-o", "moving.vtkhdf", "--steps", "2"},
           {"warp", "volume.vtkhdf", "moving.vtkhdf", "-o", "out.vtkhdf", "--steps", "1"},
           {"render", "out.vtkhdf", "-o", "picture.png"},
           {"export", "out.vtkhdf", "-o", "out.nii.gz"},
           {"import", "out.nii.gz", "-o", "back.vtkhdf"},
           {"info", "back.vtkhdf"},
           {"demo", "-o", "demo", "--dims", "16,16,16", "--steps", "2"}}) {
    Names words = command;
    words.push_back("--quiet");

    const CommandResult result = run_command(scene, words);

    EXPECT_EQ(result.exit_code, 0) << command.front() << ": " << result.err;
    EXPECT_EQ(result.out + result.err, "") << command.front();
  }
}

TEST(Cli, WarpsByHexahedraAsTheLibraryDoes) {
  const TemporaryFolder folder;
  const Volume phantom = make_phantom({24, 16, 12});
  write_volumes(folder / "volume.vtkhdf", {&phantom});
  const std::vector<Names> commands{
      {"mesh", "volume.vtkhdf", "-o", "mesh.vtkhdf", "--cells", "3", "--hexahedra"},
      {"deform", "mesh.vtkhdf", "-o", "moving.vtkhdf", "--kind", "twist", "--steps", "2"},
      {"warp", "volume.vtkhdf", "moving.vtkhdf", "-o", "out.vtkhdf", "--outputs", "tet", "--steps",
       "1"},
      {"info", "moving.vtkhdf"}};
  std::string last;
  for (const Names& command : commands) {
    const CommandResult result = run_command(folder, command);
    ASSERT_EQ(result.exit_code, 0) << command.front() << ": " << result.err;
    last = result.out;
  }

  const MeshReader reader(folder / "moving.vtkhdf");
  const auto here = warp(phantom, reader.mesh(), reader.read_step(1), {.backend = Backend::cpu});
  EXPECT_EQ(read_volume(folder / "out.vtkhdf").data, here.volume.data);
  const Volume owner = read_volume(folder / "out.vtkhdf", "tetwarp_tet");
  const auto owners = owner.samples<std::int32_t>();
  EXPECT_EQ(*std::max_element(owners.begin(), owners.end()), reader.header().hex_count - 1);
  EXPECT_NE(last.find("tetrahedra: 0\nhexahedra: 18\n"), std::string::npos) << last;
}

TEST(Cli, InfoShowsVolumesAndMeshesForPeopleAndMachines) {
  const Scene scene;

  const CommandResult volume = run_command(scene, {"info", "volume.vtkhdf", "--stats", "--json"});
  const CommandResult mesh = run_command(scene, {"info", "mesh.vtkhdf"});

  const auto json = nlohmann::json::parse(volume.out);
  EXPECT_EQ(json["kind"], "volume");
  EXPECT_EQ(json["dims"], (std::vector<int>{12, 10, 8}));
  EXPECT_EQ(json["arrays"]["density"]["type"], "float32");
  EXPECT_EQ(json["arrays"]["density"]["min"], 1.0);
  EXPECT_EQ(json["arrays"]["density"]["max"], 960.0);
  EXPECT_NE(mesh.out.find("kind: mesh\nnodes: 8\ntetrahedra: 5\nsteps: 4\n"), std::string::npos)
      << mesh.out;
}

TEST(Cli, InfoShowsTheFiniteRangeAndCountsTheOtherSamples) {
  const TemporaryFolder folder;
  Volume volume = ramp_volume<float>();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  volume.samples<float>()[0] = std::numeric_limits<float>::quiet_NaN();
  volume.samples<float>()[7] = infinity;
  volume.samples<float>()[8] = -infinity;
  write_volumes(folder / "volume.vtkhdf", {&volume});

  const CommandResult result = run_command(folder, {"info", "volume.vtkhdf", "--stats", "--json"});

  const auto json = nlohmann::json::parse(result.out)["arrays"]["density"];
  EXPECT_EQ(json["min"], 2.0);
  EXPECT_EQ(json["max"], 960.0);
  EXPECT_EQ(json["nan"], 1);
  EXPECT_EQ(json["infinite"], 2);
}

TEST(Cli, DemoNeedsNoFileAndWritesAllOutputs) {
  const TemporaryFolder folder;

  const CommandResult result =
      run_command(folder, {"demo", "-o", "demo", "--dims", "32,20,16", "--steps", "2"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const std::string name : {"volume.vtkhdf", "mesh.vtkhdf", "warped_0000.vtkhdf",
                                 "warped_0001.vtkhdf", "before_after.png", "report.json"}) {
    EXPECT_TRUE(fs::exists(folder.path() / "demo" / name)) << name;
  }
  EXPECT_NE(result.out.find("before_after.png"), std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test
