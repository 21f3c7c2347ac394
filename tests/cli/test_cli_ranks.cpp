/// @file test_cli_ranks.cpp
/// `mpirun -n 3 tetwarp warp`: outputs and blocks are divided among ranks, errors printed once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;
using Json = nlohmann::json;

/// A scene of 4 steps, warped by one process and by three.
class Ranks : public testing::Test {
 protected:
  void SetUp() override {
    if (std::string(TETWARP_MPIRUN).empty()) GTEST_SKIP() << "this build does not support MPI";
  }

  /// mpirun of Open MPI 4.1 sometimes hangs in PMIx_server_finalize after a rank has failed and all
  /// have ended. It is then killed and started again, up to three times. A deadlock of the ranks
  /// would hang every time and fail the test. It has a folder of its own for its sockets: two
  /// processes at the same time sometimes fail to create the common one.
  CommandResult run_three(Names words) const {
    words.insert(words.begin(), "warp");
    constexpr int was_killed = 137;
    constexpr const char* no_leak_check = "ASAN_OPTIONS=detect_leaks=0";  // Open MPI has leaks
    CommandResult result;
    for (int attempt = 0; attempt < 3; ++attempt) {
      result =
          run_command(scene, words,
                      {.launcher = {"/usr/bin/timeout", "--signal=KILL", "40", "/usr/bin/env",
                                    "OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
                                    "OMPI_MCA_rmaps_base_oversubscribe=1",
                                    "OMPI_MCA_orte_tmpdir_base=" + sockets.path().string(),
                                    no_leak_check, TETWARP_MPIRUN, "-n", "3"}});
      if (result.exit_code != was_killed) return result;
    }
    ADD_FAILURE() << "killed three times after 40 s: " << result.err;
    return result;
  }

  /// Expects files and sums of three ranks to be those of one.
  void expect_same(const Names& endings, Names words) const {
    words.insert(words.begin(), {"volume.vtkhdf", "mesh.vtkhdf", "--outputs", "mask,tet"});
    Names one = words;
    one.insert(one.begin(), "warp");
    one.insert(one.end(), {"-o", "one.vtkhdf", "--report", "one.json"});
    words.insert(words.end(), {"-o", "three.vtkhdf", "--report", "three.json"});
    const CommandResult alone = run_command(scene, one);
    const CommandResult shared = run_three(words);
    ASSERT_EQ(alone.exit_code, 0) << alone.err;
    ASSERT_EQ(shared.exit_code, 0) << shared.err;
    EXPECT_EQ(std::ranges::count(shared.out, '\n'), 1) << shared.out;
    for (const std::string& ending : endings) {
      const VolumeHeader header = read_volume_header(scene / ("one" + ending));
      EXPECT_EQ(read_volume_header(scene / ("three" + ending)).arrays, header.arrays);
      for (const ArrayHeader& array : header.arrays) {
        for (std::int64_t step = 0; step < std::max<std::int64_t>(1, std::ssize(header.times));
             ++step) {
          EXPECT_EQ(read_volume(scene / ("one" + ending), array.name, step).data,
                    read_volume(scene / ("three" + ending), array.name, step).data)
              << array.name << ending;
        }
      }
    }
    const Json a = Json::parse(text_of(scene / "one.json"));
    const Json b = Json::parse(text_of(scene / "three.json"));
    for (const char* sum : {"voxels", "covered", "outside", "tetrahedra"}) {
      EXPECT_EQ(a["counts"][sum], b["counts"][sum]) << sum;
    }
    ASSERT_EQ(a["steps"].size(), b["steps"].size());
    for (std::size_t s = 0; s < a["steps"].size(); ++s) {
      EXPECT_EQ(a["steps"][s]["step"], b["steps"][s]["step"]);
    }
  }

  Scene scene;
  TemporaryFolder sockets;
};

int lines_of_ours(const std::string& text) {
  int count = text.starts_with("tetwarp: ");
  for (std::size_t at = 0; (at = text.find("\ntetwarp: ", at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST_F(Ranks, ShareOutputsAndLeaveTheSameFiles) {
  expect_same({"_0000.vtkhdf", "_0001.vtkhdf", "_0002.vtkhdf", "_0003.vtkhdf"},
              {"--no-skip", "unchanged-steps"});
}

/// Large enough for several blocks.
Volume write_large_scene(const Scene& scene) {
  Grid grid;
  grid.dims = {130, 70, 66};
  Volume volume = make_volume(grid, PixelType::int16, 2, "density");
  std::int16_t value = 0;
  for (std::int16_t& sample : volume.samples<std::int16_t>()) sample = value += 7;
  write_volumes(scene / "volume.vtkhdf", {&volume});
  Mesh mesh = box_mesh();
  for (Point3& p : mesh.rest_positions) p = {5 * p[0] - 20, 4 * p[1] + 15, 5 * p[2] - 500};
  write_mesh(scene / "mesh.vtkhdf", mesh, shifts({0.3, 0.3, 8.25}), {0, 1, 2});
  return volume;
}

/// Each of three unpacks 130 x 70 x 66 voxels of four bytes, and the first one keeps as many.
TEST_F(Ranks, CountTheTemporaryFilesOfAll) {
  write_nifti(scene / "head.nii.gz", write_large_scene(scene));

  const CommandResult planned =
      run_three({"head.nii.gz", "mesh.vtkhdf", "-o", "out.nii.gz", "--steps", "2", "--dry-run"});

  EXPECT_EQ(planned.exit_code, 0) << planned.err;
  EXPECT_NE(planned.out.find("9.2 MiB of disk"), std::string::npos) << planned.out;
}

TEST_F(Ranks, ShareBlocksOfAGzipImage) {
  write_nifti(scene / "head.nii.gz", write_large_scene(scene));
  const Names words{"head.nii.gz", "mesh.vtkhdf", "--steps", "2", "--filter", "cubic", "-o"};
  Names one = words, three = words;
  one.insert(one.begin(), "warp");
  one.push_back("one.nii.gz");
  three.push_back("three.nii.gz");
  ASSERT_EQ(run_command(scene, one).exit_code, 0);

  const CommandResult shared = run_three(three);

  ASSERT_EQ(shared.exit_code, 0) << shared.err;
  EXPECT_TRUE(text_of(scene / "three.nii.gz") == text_of(scene / "one.nii.gz"));
  EXPECT_EQ(scene.names(),
            (Names{"head.nii.gz", "mesh.vtkhdf", "one.nii.gz", "three.nii.gz", "volume.vtkhdf"}));
}

TEST_F(Ranks, ShareBlocksOfASingleOutput) {
  write_large_scene(scene);

  expect_same({".vtkhdf"}, {"--steps", "2", "--filter", "cubic", "--overshoot", "clamp"});
  EXPECT_GE(Json::parse(text_of(scene / "three.json"))["counts"]["blocks"], 6);
  expect_same({".vtkhdf"}, {"--temporal", "--roi", "5:129,0:70,3:66", "--outside", "identity"});
}

TEST_F(Ranks, EndTogetherWithOneLineWhenOneOfThemFails) {
  auto steps = shifts({0, 1, 1, 3});
  steps[2][3][1] = 1e300;
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), steps, {0, 1, 2, 3});

  for (const Names& more : {Names{}, Names{"--temporal"}, Names{"--steps", "2"}}) {
    Names words{"volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run_three(words);

    EXPECT_NE(result.exit_code, 0);
    EXPECT_GE(lines_of_ours(result.err), 1) << result.err;
    EXPECT_NE(result.err.find("2^40 voxels"), std::string::npos) << result.err;
    for (const std::string& name : scene.names()) EXPECT_FALSE(name.starts_with(".")) << name;
    EXPECT_FALSE(fs::exists(scene / "out.vtkhdf"));
    EXPECT_FALSE(fs::exists(scene / "out_0002.vtkhdf"));
  }
}

TEST_F(Ranks, PrintACommonErrorOnce) {
  for (const Names& words :
       {Names{"volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--memory", "much"},
        Names{"volume.vtkhdf", "none.vtkhdf", "-o", "out.vtkhdf"},
        Names{"volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--resume", "--provenance"},
        Names{"--batch", "jobs.json"}}) {
    const CommandResult result = run_three(words);

    EXPECT_NE(result.exit_code, 0);
    EXPECT_EQ(lines_of_ours(result.err), 1) << result.err;
    EXPECT_EQ(scene.names(), scene.inputs);
  }
}

/// The ranks compute one output in blocks.
TEST_F(Ranks, StopAStrictWarpBeforeTheOutputGetsItsName) {
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({100}), {0});
  const Names before = scene.names();
  Names words{"volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"};

  const CommandResult warned = run_three(words);
  EXPECT_EQ(warned.exit_code, 0) << warned.err;
  EXPECT_NE(warned.err.find("tetwarp: warning: mesh.vtkhdf: the mesh covers no voxel"),
            std::string::npos)
      << warned.err;
  fs::remove(scene / "out.vtkhdf");

  words.push_back("--strict");
  const CommandResult refused = run_three(words);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("covers no voxel"), std::string::npos) << refused.err;
  EXPECT_EQ(scene.names(), before);
}

TEST_F(Ranks, PairTheStepsOfVolumeAndMesh) {
  TemporalVolumeWriter writer(scene / "volume.vtkhdf");
  for (int step = 0; step < 4; ++step) {
    Volume volume = ramp_volume<float>();
    for (float& sample : volume.samples<float>()) sample *= static_cast<float>(step + 1);
    writer.append(step, {&volume});
  }
  writer.finish();

  expect_same({".vtkhdf"}, {"--pair", "--temporal", "--overshoot", "clamp"});
}
}  // namespace
}  // namespace tetwarp::test
