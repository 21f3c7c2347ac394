/// @file test_cli_warnings.cpp
/// Warnings on standard error and in the report, and --strict, which makes them errors.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

class CliWarnings : public testing::Test {
 protected:
  /// Runs with more words, expects one warning on standard error and in the report, and an error
  /// in place of outputs with --strict.
  void expect_warning(Names words, const std::string& warning) const {
    words.insert(words.begin(), {"-o", "out.vtkhdf"});
    Names strict = words;
    strict.push_back("--strict");
    const Names before = scene.names();

    const CommandResult refused = scene.warp(strict);

    EXPECT_EQ(refused.exit_code, 1) << refused.err;
    EXPECT_TRUE(refused.has_one_line_error()) << refused.err;
    EXPECT_NE(refused.err.find(warning), std::string::npos) << refused.err;
    EXPECT_EQ(scene.names(), before);

    words.insert(words.end(), {"--report", "report.json"});
    const CommandResult warned = scene.warp(words);
    EXPECT_EQ(warned.exit_code, 0) << warned.err;
    EXPECT_TRUE(warned.has_one_line_error()) << warned.err;
    EXPECT_TRUE(warned.err.starts_with("tetwarp: warning: ")) << warned.err;
    EXPECT_NE(warned.err.find(warning), std::string::npos) << warned.err;
    const Names reported = warnings_of("report.json");
    ASSERT_EQ(reported.size(), 1u);
    EXPECT_EQ("tetwarp: warning: " + reported.front() + "\n", warned.err);

    words.push_back("--quiet");
    EXPECT_EQ(scene.warp(words).err, "");
    EXPECT_EQ(warnings_of("report.json"), reported);
  }

  Names warnings_of(const std::string& report) const {
    return nlohmann::json::parse(text_of(scene / report)).at("warnings").get<Names>();
  }

  Scene scene;
};

TEST_F(CliWarnings, AreNoneForAnOrdinaryWarp) {
  const CommandResult result =
      scene.warp({"-o", "out.vtkhdf", "--strict", "--report", "report.json"});

  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(warnings_of("report.json"), Names{});
}

/// A warp that keeps totals counts them once: the output is that of the mesh without the copies.
TEST_F(CliWarnings, NameCellsThatAreThereTwice) {
  const Names conservative{"--steps", "3", "--intensity", "conservative"};
  Names once{"-o", "once.vtkhdf", "--quiet"};
  once.insert(once.end(), conservative.begin(), conservative.end());
  ASSERT_EQ(scene.warp(once).exit_code, 0);
  Mesh mesh = box_mesh();
  mesh.tets.insert(mesh.tets.begin() + 1, {6, 5, 3, 0});
  mesh.tets.push_back(mesh.tets[2]);
  write_mesh(scene / "mesh.vtkhdf", mesh, shifts({0, 1, 1, 3}), {0, 0.5, 1, 1.5});

  expect_warning(conservative, "mesh.vtkhdf: 2 of 7 cells are there twice and were merged");

  EXPECT_EQ(read_volume(scene / "out.vtkhdf").data, read_volume(scene / "once.vtkhdf").data);
}

TEST_F(CliWarnings, NameInvertedCells) {
  std::vector<Point3> mirrored;
  for (const Point3& x : box_mesh().rest_positions) mirrored.push_back({32 - 2 * x[0], 0, 0});
  const std::vector<Point3> still(mirrored.size(), Point3{});
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), {still, mirrored, mirrored}, {0, 1, 2});

  expect_warning({"--steps", "1:", "--temporal"},
                 "mesh.vtkhdf: 5 of 5 tetrahedra are inverted at step 1");
  EXPECT_NE(warnings_of("report.json").front().find("at step 1 and 1 more: their voxels show"),
            std::string::npos);
  EXPECT_EQ(scene.warp({"-o", "still.vtkhdf", "--steps", "0"}).err, "");
}

TEST_F(CliWarnings, NameAMeshWithoutADeformation) {
  write_mesh(scene / "mesh.vtkhdf", box_mesh());

  expect_warning({}, "mesh.vtkhdf: the mesh has no point array 'displacement'");
}

TEST_F(CliWarnings, NameAMeshThatCoversNothing) {
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({100}), {0});

  expect_warning({}, "mesh.vtkhdf: the mesh covers no voxel of an output at step 0;");
}

TEST_F(CliWarnings, StopAStrictSeriesBeforeTheStepTheyConcern) {
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({0, 100, 0}), {0, 1, 2});
  const Names before = scene.names();

  EXPECT_EQ(scene.warp({"-o", "out.vtkhdf", "--strict", "--temporal"}).exit_code, 1);
  EXPECT_EQ(scene.names(), before);

  EXPECT_EQ(scene.warp({"-o", "out.vtkhdf", "--strict"}).exit_code, 1);
  EXPECT_EQ(scene.names(), (Names{"mesh.vtkhdf", "out_0000.vtkhdf", "volume.vtkhdf"}));
}

TEST_F(CliWarnings, NameABackgroundThatDoesNotFitTheSamples) {
  const Volume volume = ramp_volume<std::uint8_t>();
  write_volumes(scene / "volume.vtkhdf", {&volume});

  expect_warning({"--steps", "0", "--background", "300"},
                 "volume.vtkhdf: density: --background 300 does not fit uint8, 255 is stored");
  expect_warning({"--steps", "0", "--background", "0.5"}, "does not fit uint8, 0 is stored");
  EXPECT_EQ(
      scene.warp({"-o", "o.vtkhdf", "--steps", "0", "--background", "0.5", "--outside", "identity"})
          .err,
      "");
}

TEST_F(CliWarnings, NameTotalsThatIntegersDoNotKeep) {
  const Volume volume = ramp_volume<std::uint8_t>();
  write_volumes(scene / "volume.vtkhdf", {&volume});

  expect_warning({"--steps", "0", "--intensity", "conservative"},
                 "volume.vtkhdf: density: --intensity conservative rounds to whole numbers");
}

/// Frames of FreeSurfer have numbers in place of times.
TEST_F(CliWarnings, NameTimesThatAnImageDoesNotHold) {
  const CommandResult numbered = scene.warp({"-o", "out.mgz", "--temporal"});
  const CommandResult timed = scene.warp({"-o", "out.nrrd", "--temporal"});

  EXPECT_EQ(numbered.exit_code, 0) << numbered.err;
  EXPECT_NE(numbered.err.find("out.mgz: images of FreeSurfer number their frames"),
            std::string::npos)
      << numbered.err;
  EXPECT_EQ(timed.err, "");
  EXPECT_EQ(read_volume_header(scene / "out.nrrd").times, (std::vector<double>{0, 0.5, 1, 1.5}));
}

TEST_F(CliWarnings, NameTheJobOfABatch) {
  write_mesh(scene / "mesh.vtkhdf", box_mesh());
  write_text(scene / "jobs.json",
             R"({"jobs": [{"volume": "volume.vtkhdf", "mesh": "mesh.vtkhdf", "output": "a.h5"},
                 {"volume": "volume.vtkhdf", "mesh": "mesh.vtkhdf", "output": "b.h5",
                  "strict": true}]})");

  const CommandResult result = run_command(scene, {"warp", "--batch", "jobs.json"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("tetwarp: job 1: warning: mesh.vtkhdf: "), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("tetwarp: job 2: mesh.vtkhdf: "), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(scene / "b.h5"));
}

/// A transform names what a mesh that does the same names, and refuses it with --strict.
TEST_F(CliWarnings, AreThoseOfAMeshForTransforms) {
  write_mesh(scene / "still.vtkhdf", box_mesh(), shifts({0}));
  write_text(scene / "still.tfm",
             "#Insight Transform File V1.0\n#Transform 0\nTransform: "
             "TranslationTransform_double_3_3\nParameters: 0 0 0\nFixedParameters: \n");
  const Volume floats = ramp_volume<float>(), mask = ramp_volume<std::int16_t>("tetwarp_mask");
  write_volumes(scene / "warped.vtkhdf", {&floats, &mask});
  write_nifti(scene / "whole.nii", ramp_volume<std::int16_t>());
  TemporalVolumeWriter writer(scene / "uneven.vtkhdf");
  for (const double time : {0., 1., 5., 6.}) writer.append(time, {&floats});
  writer.finish();
  struct Case {
    std::string volume;
    Names options;
    bool is_warning;
  };
  for (const auto& [volume, options, is_warning] :
       {Case{"uneven.vtkhdf", {"-o", "out.nii"}, true},
        {"uneven.vtkhdf", {"-o", "out.mgz"}, true},
        {"uneven.vtkhdf", {"-o", "out.mha"}, true},
        {"uneven.vtkhdf", {"-o", "out.vtkhdf"}, false},
        {"whole.nii", {"-o", "out.nii", "--background", "1e9"}, true},
        {"whole.nii", {"-o", "out.nii", "--background", "9"}, false},
        {"volume.vtkhdf", {"-o", "out.nii", "--filter", "labels"}, false},
        {"warped.vtkhdf", {"-o", "out.vtkhdf"}, false}}) {
    const auto run = [&](const std::string& deformation, const Names& more) {
      Names words{"warp", volume, deformation};
      words.insert(words.end(), options.begin(), options.end());
      words.insert(words.end(), more.begin(), more.end());
      return run_command(scene, words);
    };
    const Names before = scene.names();
    const CommandResult refused = run("still.tfm", {"--strict"});
    EXPECT_EQ(refused.exit_code, is_warning ? 1 : 0) << refused.err;
    EXPECT_EQ(refused.err, run("still.vtkhdf", {"--strict"}).err);
    EXPECT_EQ(scene.names() == before, is_warning);

    const CommandResult result = run("still.tfm", {"--report", "report.json"});
    const CommandResult by_mesh = run("still.vtkhdf", {"--report", "mesh.json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, by_mesh.err);
    EXPECT_EQ(warnings_of("report.json"), warnings_of("mesh.json"));
    EXPECT_EQ(warnings_of("report.json").size(), is_warning ? 1u : 0u);
    EXPECT_EQ(nlohmann::json::parse(text_of(scene / "report.json"))["notes"],
              nlohmann::json::parse(text_of(scene / "mesh.json"))["notes"]);
    for (const char* extension : {"nii", "mgz", "mha", "vtkhdf"}) {
      fs::remove(scene / (std::string("out.") + extension));
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
