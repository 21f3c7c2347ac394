/// @file test_cli_outputs.cpp
/// Names of outputs: files that exist, that are inputs, in folders that do not exist, and in any
/// bytes.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <tetwarp/scene_io.hpp>

#include "tests/support/cli_scene.hpp"
#include "tests/support/contact/contact_files.hpp"
#include "tests/support/refused_line.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// Inputs of all commands.
class CliOutputs : public testing::Test {
 protected:
  CliOutputs() {
    Volume volume = ramp_volume<float>("values");
    write_nifti(scene / "image.nii", volume);
    write_text(scene / "scene.json",
               R"({"tetwarp_scene": 1, "time_step": 0.01, "duration": 0.02, "bodies": [
                 {"name": "ball", "kind": "rigid", "density": 500, "mesh": {"file": "skin.vtkhdf"}}]})");
    EXPECT_EQ(run_command(scene, {"mesh", "image.nii", "-o", "lattice.vtkhdf", "--surface",
                                  "skin.vtkhdf", "--cells", "2", "--quiet"})
                  .exit_code,
              0);
    write_contact_problem(scene / "problem.hdf5", sliding_point());
  }

  /// Commands without their last word, the output, and one of its names.
  struct Command {
    Names words;
    std::string output;
  };
  const std::vector<Command> commands{
      {{"import", "image.nii", "-o"}, "out.vtkhdf"},
      {{"export", "volume.vtkhdf", "-o"}, "out.nii"},
      {{"export", "volume.vtkhdf", "-o"}, "out.nii.gz"},
      {{"deform", "mesh.vtkhdf", "--steps", "1", "-o"}, "out.vtkhdf"},
      {{"mesh", "image.nii", "--cells", "2", "-o"}, "out.vtkhdf"},
      {{"mesh", "image.nii", "--cells", "6", "-o", "other.vtkhdf", "--surface"}, "out.vtkhdf"},
      {{"mesh", "--from-surface", "skin.vtkhdf", "--cells", "2", "-o"}, "out.vtkhdf"},
      {{"render", "image.nii", "-o"}, "out.png"},
      {{"warp", "volume.vtkhdf", "mesh.vtkhdf", "--steps", "3", "-o"}, "out.vtkhdf"},
      {{"warp", "volume.vtkhdf", "mesh.vtkhdf", "--temporal", "-o"}, "out.vtkhdf"},
      {{"warp", "image.nii", "mesh.vtkhdf", "--steps", "3", "-o"}, "out.nii.gz"},
      {{"contact", "problem.hdf5", "-o"}, "out.hdf5"},
  };

  CommandResult run(const Command& command, const std::string& output) const {
    Names words = command.words;
    words.insert(words.end(), {output, "--quiet"});
    return run_command(scene, words);
  }

  Scene scene;
};

/// Nothing, other content of fewer and of more bytes, a small file of the same format.
TEST_F(CliOutputs, ReplaceExistingFilesOfAnySizeAndKind) {
  write_mesh(scene / "small.vtkhdf", box_mesh());
  const Names before{"", "x", text_of(scene / "small.vtkhdf"), std::string(3'000'000, 'x')};
  for (const Command& command : commands) {
    fs::remove(scene / command.output);
    EXPECT_EQ(run(command, command.output).exit_code, 0) << command.words.front();
    const std::string expected = text_of(scene / command.output);
    for (const std::string& content : before) {
      write_text(scene / command.output, content);

      const CommandResult result = run(command, command.output);

      EXPECT_EQ(result.exit_code, 0) << command.words.front() << ": " << result.err;
      EXPECT_TRUE(text_of(scene / command.output) == expected) << command.words.front();
    }
  }
}

TEST_F(CliOutputs, ThatAreInputsAreRefusedAndKept) {
  const std::string bytes = text_of(scene / "skin.vtkhdf");
  write_text(scene / "colors.png", "{}");
  for (const Names& words :
       {Names{"mesh", "--from-surface", "skin.vtkhdf", "-o", "./skin.vtkhdf"},
        Names{"mesh", "--from-surface", "skin.vtkhdf", "-o", "m.vtkhdf", "--surface",
              "skin.vtkhdf"},
        Names{"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "volume.vtkhdf", "--steps", "0"},
        Names{"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "o.vtkhdf", "--report", "mesh.vtkhdf"},
        Names{"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "image.nii", "--grid", "image.nii",
              "--steps", "0"},
        Names{"deform", "mesh.vtkhdf", "-o", "mesh.vtkhdf"},
        Names{"export", "image.nii", "-o", "image.nii"},
        Names{"contact", "problem.hdf5", "-o", "o.hdf5", "--report", "problem.hdf5"},
        Names{"render", "image.nii", "-o", "colors.png", "--cast", "colors.png"},
        Names{"simulate", "scene.json", "-o", "out", "--picture", "--cast", "colors.png",
              "--checkpoint", "colors.png"},
        Names{"simulate", "scene.json", "-o", "out", "--report", "scene.json"}}) {
    expect_refused_line(scene, words, "is also an input; name another output");
  }
  fs::create_directory(scene / "run");
  fs::copy_file(scene / "skin.vtkhdf", scene / "run/ball.vtkhdf");
  write_text(scene / "run/scene.json",
             R"({"tetwarp_scene": 1, "time_step": 0.01, "duration": 0.02, "bodies": [
               {"name": "ball", "kind": "rigid", "density": 500, "mesh": {"file": "ball.vtkhdf"}}]})");
  expect_refused_line(scene, {"simulate", "run/scene.json", "-o", "run"},
                      "is an input, and body 'ball' would be written to it");
  expect_refused_line(scene, {"simulate", "scene.json", "-o", "out", "--contacts", "skin.vtkhdf"},
                      "is an input and the file of --contacts");
  fs::copy_file(scene / "scene.json", scene / "run/report.json");
  fs::copy_file(scene / "skin.vtkhdf", scene / "run/skin.vtkhdf");
  expect_refused_line(scene, {"simulate", "run/report.json", "-o", "run"},
                      "is an input and the report of the run");
  EXPECT_TRUE(text_of(scene / "skin.vtkhdf") == bytes);
  EXPECT_TRUE(text_of(scene / "run/ball.vtkhdf") == bytes);
}

/// A command that fails leaves no folder.
TEST_F(CliOutputs, GetTheFoldersThatTheyAreIn) {
  for (const Command& command : commands) {
    EXPECT_EQ(run(command, "new/folder/" + command.output).exit_code, 0) << command.words.front();
    EXPECT_TRUE(fs::exists(scene / ("new/folder/" + command.output))) << command.words.front();
    fs::remove_all(scene / "new");
  }
  for (const std::string report : {"a/b/report.json", "a/contacts.vtkhdf"}) {
    const std::string option = report.ends_with("json") ? "--report" : "--contacts";
    EXPECT_EQ(run_command(scene, {"simulate", "scene.json", "-o", "s/t", option, report, "--quiet"})
                  .exit_code,
              0);
    EXPECT_TRUE(fs::exists(scene / report)) << report;
  }
  expect_refused_line(scene, {"export", "volume.vtkhdf", "--array", "none", "-o", "n/o.nii"},
                      "none");
  expect_refused_line(scene, {"export", "volume.vtkhdf", "-o", "image.nii/o.nii"},
                      "is not a folder; name another one");
}

TEST_F(CliOutputs, MayHaveSuffixesInCapitalLetters) {
  EXPECT_EQ(run_command(scene, {"warp", "image.nii", "mesh.vtkhdf", "--steps", "3", "-o",
                                "OUT.NII.GZ", "--outputs", "mask"})
                .exit_code,
            0);
  EXPECT_EQ(text_of(scene / "OUT.NII.GZ").substr(0, 2), "\x1f\x8b");
  EXPECT_TRUE(fs::exists(scene / "OUT_mask.NII.GZ"));
  fs::copy_file(scene / "OUT.NII.GZ", scene / "IN.NII.GZ");
  EXPECT_EQ(run_command(scene, {"import", "IN.NII.GZ", "-o", "OUT.VTKHDF"}).exit_code, 0);
  EXPECT_EQ(run_command(scene, {"render", "OUT.VTKHDF", "-o", "OUT.PNG"}).exit_code, 0);
}

/// Commands name the step or array that they choose, and adhesion that never breaks.
TEST_F(CliOutputs, AreExplainedWhereInputsHoldMore) {
  TemporalVolumeWriter writer(scene / "series.vtkhdf");
  for (const double time : {0.0, 1.0}) {
    const Volume volume = ramp_volume<float>("values");
    writer.append(time, {&volume});
  }
  writer.finish();
  const std::string told = "series.vtkhdf: takes step 0 of 2; --step names another";
  for (const Names& words : {Names{"export", "series.vtkhdf", "-o", "o.nii"},
                             Names{"mesh", "series.vtkhdf", "-o", "o.vtkhdf", "--cells", "2"},
                             Names{"render", "series.vtkhdf", "-o", "o.png"}}) {
    EXPECT_NE(run_command(scene, words).err.find(told), std::string::npos) << words.front();
    Names chosen = words;
    chosen.insert(chosen.end(), {"--step", "0"});
    EXPECT_EQ(run_command(scene, chosen).err, "") << words.front();
  }
  write_text(scene / "glue.json",
             R"({"tetwarp_scene": 1, "time_step": 0.01, "duration": 0.01,
                 "contact": {"adhesion": {"stiffness": 1e6, "energy": 0}}, "bodies": [
                 {"name": "ball", "kind": "rigid", "density": 500, "mesh": {"file": "skin.vtkhdf"}}]})");
  EXPECT_NE(run_command(scene, {"simulate", "glue.json", "-o", "out"})
                .err.find("contact.adhesion: with energy 0 and viscosity 0 bonds never weaken"),
            std::string::npos);
}

/// Names of files are bytes. JSON is UTF-8: other bytes become U+FFFD there.
TEST_F(CliOutputs, MayHaveNamesThatAreNoText) {
  const std::string name = "a\xff\xfe.vtkhdf";
  const CommandResult result =
      run_command(scene, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "--steps", "3", "-o", name,
                          "--report", "report.json"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(fs::exists(scene / name));
  const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
  EXPECT_EQ(report["outputs"][0], "a\uFFFD\uFFFD.vtkhdf");
  fs::copy_file(scene / "volume.vtkhdf", scene / "in\xff.vtkhdf");
  write_text(scene / "jobs.json", R"({"jobs": [{"volume": "none.vtkhdf", "mesh": "mesh.vtkhdf",
                                     "output": "o.vtkhdf"}]})");
  EXPECT_EQ(run_command(scene, {"warp", "--batch", "jobs.json", "--grid", "in\xff.vtkhdf",
                                "--report", "batch.json"})
                .exit_code,
            1);
  EXPECT_TRUE(nlohmann::json::accept(text_of(scene / "batch.json")));
}
}  // namespace
}  // namespace tetwarp::test
