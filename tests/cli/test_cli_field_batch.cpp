/// @file test_cli_field_batch.cpp
/// --batch with warps by displacement fields.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/files/sha256.hpp"
#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// A scene with a displacement field, and a folder for batch files.
class FieldBatch : public testing::Test {
 protected:
  FieldBatch() {
    fs::create_directory(scene / "jobs");
    made({"compose", "mesh.vtkhdf", "-o", "field.vtkhdf", "--like", "volume.vtkhdf", "--steps",
          "3"});
  }

  CommandResult made(const Names& words) const {
    CommandResult result = run_command(scene, words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result;
  }
  bool exists(const std::string& name) const { return fs::exists(scene / name); }

  Scene scene;
};

/// One after the other and beside each other, a warp by a mesh among them; with --resume those that
/// are as their files tell are skipped.
TEST_F(FieldBatch, RunsBesideWarpsByAMesh) {
  made({"warp", "volume.vtkhdf", "field.vtkhdf", "-o", "alone.nii", "--filter", "cubic"});
  const std::string list =
      "volume,mesh,transform,output,filter,steps\n"
      "volume.vtkhdf,,field.vtkhdf,one.nii,cubic,\n"
      "volume.vtkhdf,mesh.vtkhdf,,two.nii,,3\n"
      "volume.vtkhdf,field.vtkhdf,,three.nii,cubic,\n";
  write_text(scene / "jobs.csv", list);
  const std::string alone = sha256_of_file(scene / "alone.nii");
  for (const char* jobs : {"1", "2"}) {
    made({"warp", "--batch", "jobs.csv", "--jobs", jobs, "--provenance", "--report", "all.json"});
    EXPECT_EQ(sha256_of_file(scene / "one.nii"), alone);
    EXPECT_EQ(sha256_of_file(scene / "three.nii"), alone);
    EXPECT_TRUE(exists("two.nii"));
    const auto report = nlohmann::json::parse(text_of(scene / "all.json"));
    EXPECT_EQ(report["jobs_done"], 3);
    const auto inputs = nlohmann::json::parse(text_of(scene / "one.nii.json"))["inputs"];
    EXPECT_EQ(inputs[1]["role"], "transform");
    if (*jobs == '1') {
      for (const char* name : {"one.nii", "two.nii", "three.nii"}) fs::remove(scene / name);
    }
  }
  fs::remove(scene / "three.nii");
  made({"warp", "--batch", "jobs.csv", "--jobs", "2", "--provenance", "--resume", "--report",
        "all.json"});
  const auto report = nlohmann::json::parse(text_of(scene / "all.json"));
  EXPECT_EQ(report["jobs_done"], 1);
  EXPECT_EQ(report["jobs_skipped"], 2);
  EXPECT_EQ(sha256_of_file(scene / "three.nii"), alone);
}

/// The step is a default of fields with several steps, of which each job takes one.
TEST_F(FieldBatch, TakesStepsForFieldsOfSeveral) {
  made({"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "fields.nii", "--outputs", "displacement",
        "--temporal"});
  write_text(scene / "jobs.csv",
             "volume,transform,output\n"
             "volume.vtkhdf,fields_displacement.nii,several.nii\n"
             "volume.vtkhdf,field.vtkhdf,single.nii\n");
  for (const char* step : {"1", "3"}) {
    made({"warp", "volume.vtkhdf", "fields_displacement.nii", "-o", "alone.nii", "--steps", step});
    made({"warp", "--batch", "jobs.csv", "--steps", step, "--report", "all.json"});
    EXPECT_EQ(sha256_of_file(scene / "several.nii"), sha256_of_file(scene / "alone.nii"));
    const auto jobs = nlohmann::json::parse(text_of(scene / "all.json"))["jobs"];
    EXPECT_FALSE(jobs[0].contains("defaults_left_out"));
    EXPECT_TRUE(jobs[1].contains("defaults_left_out"));
  }
}

/// Defaults that only warps by a mesh have are left out of the others.
TEST_F(FieldBatch, TakesDefaultsOfMeshesForMeshesAlone) {
  write_text(scene / "jobs.csv",
             "volume,mesh,transform,output\n"
             "volume.vtkhdf,,field.vtkhdf,one.nii\n"
             "volume.vtkhdf,mesh.vtkhdf,,two.nii\n");
  for (const char* jobs : {"1", "2"}) {
    made({"warp", "--batch", "jobs.csv", "--jobs", jobs, "--memory", "4G", "--strict", "--device",
          "0", "--no-skip", "all", "--steps", "3", "--filter", "cubic", "--report", "all.json"});
    const auto reports = nlohmann::json::parse(text_of(scene / "all.json"))["jobs"];
    for (const auto& report : reports) {
      const bool is_by_field = report["mesh"] == "field.vtkhdf";
      EXPECT_EQ(report.contains("defaults_left_out"), is_by_field);
      if (!is_by_field) continue;
      EXPECT_EQ(report["defaults_left_out"], (Names{"--steps=3", "--device=0", "--no-skip=all"}));
    }
    for (const char* name : {"one.nii", "two.nii"}) EXPECT_TRUE(fs::remove(scene / name)) << name;
  }
}

/// Also defaults whose value only warps by a mesh take, and those of fields of FSL.
TEST_F(FieldBatch, TakesDefaultsOnlyWhereTheyMeanSomething) {
  made({"warp", "volume.vtkhdf", "field.vtkhdf", "-o", "field.nii", "--filter", "labels"});
  made({"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "mesh.nii", "--steps", "3", "--filter",
        "labels", "--label-rule", "volume"});
  write_text(scene / "jobs.csv",
             "volume,mesh,transform,output,steps\n"
             "volume.vtkhdf,,field.vtkhdf,one.nii,\n"
             "volume.vtkhdf,field.vtkhdf,,two.nii,\n"
             "volume.vtkhdf,mesh.vtkhdf,,three.nii,3\n");
  for (const Names& defaults : {Names{"--filter", "labels", "--label-rule", "volume"},
                                {"--outside", "nearest"},
                                {"--outside", "falloff:5"},
                                {"--backend", "reference"},
                                {"--grid", "bounds"},
                                {"--resume"}}) {
    const bool is_first = defaults.front() == "--filter";
    for (const char* jobs : {"1", "3"}) {
      if (!is_first && *jobs == '3') continue;
      Names words{"warp", "--batch", "jobs.csv", "--jobs", jobs};
      words.insert(words.end(), defaults.begin(), defaults.end());
      made(words);
      for (const auto& [output, alone] : {std::pair{"one.nii", "field.nii"},
                                          {"two.nii", "field.nii"},
                                          {"three.nii", "mesh.nii"}}) {
        if (is_first) {
          EXPECT_EQ(text_of(scene / output), text_of(scene / alone)) << output;
        }
        EXPECT_TRUE(fs::remove(scene / output)) << output;
      }
    }
  }
}

TEST_F(FieldBatch, RefusesADefaultThatNoJobTakes) {
  write_text(scene / "jobs.csv",
             "volume,mesh,transform,output\n"
             "volume.vtkhdf,,field.vtkhdf,one.nii\n"
             "volume.vtkhdf,field.vtkhdf,,two.nii\n");
  for (const auto& [defaults, line] :
       {std::pair{Names{"--steps", "3"}, "--steps is for warps by a mesh; leave it out"},
        {{"--outside", "nearest"}, "--outside nearest is for warps by a mesh; use background or"},
        {{"--fsl", "relative"}, "--fsl is for warp fields of FSL, which are NIfTI images"},
        {{"--resume"}, "--resume of a warp by a transform needs --provenance; add it"}}) {
    Names words{"warp", "--batch", "jobs.csv"};
    words.insert(words.end(), defaults.begin(), defaults.end());
    const CommandResult result = run_command(scene, words);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find("jobs.csv: no job takes a default: " + std::string(line)),
              std::string::npos)
        << result.err;
  }
  write_text(scene / "jobs.csv", "volume,mesh,output,steps\nvolume.vtkhdf,mesh.vtkhdf,one.nii,3\n");
  EXPECT_NE(run_command(scene, {"warp", "--batch", "jobs.csv", "--fsl", "relative"})
                .err.find("no job takes a default: --fsl"),
            std::string::npos);
  EXPECT_FALSE(exists("one.nii") || exists("two.nii"));
}

TEST_F(FieldBatch, RefusesJobsWhoseFilesBesideOutputsAreTheSame) {
  for (const std::string deformation : {R"(mesh.vtkhdf", "steps": 3)", R"(field.vtkhdf")"}) {
    write_text(scene / "jobs/jobs.json",
               R"({"jobs": [{"volume": "../volume.vtkhdf", "output": "a.nii", "provenance": true,
                             "mesh": "../)" +
                   deformation + R"(},
                            {"volume": "../volume.vtkhdf", "output": "b.nii", "steps": 3,
                             "mesh": "../mesh.vtkhdf", "report": "./a.nii.json"}]})");
    const CommandResult result = run_command(scene, {"warp", "--batch", "jobs/jobs.json"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find("a.nii.json: job 1 and job 2 both write it"), std::string::npos)
        << result.err;
  }
  EXPECT_FALSE(exists("jobs/a.nii") || exists("jobs/b.nii"));
}

TEST_F(FieldBatch, PlansAndRefusesJobs) {
  const auto batch = [&](const Names& more) {
    std::string jobs;
    for (const std::string& one : more) {
      jobs += (jobs.empty() ? "" : ",") + std::string(R"({"volume": "../volume.vtkhdf", )") +
              R"("transform": "../field.vtkhdf", "output": "a.nii")" + one + "}";
    }
    write_text(scene / "jobs/jobs.json", "{\"jobs\": [" + jobs + "]}");
    return run_command(scene, {"warp", "--batch", "jobs/jobs.json"});
  };
  const CommandResult plan = batch({R"(, "dry-run": true)"});
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_NE(plan.out.find("of memory"), std::string::npos) << plan.out;
  EXPECT_FALSE(exists("jobs/a.nii"));
  for (const auto& [more, line] :
       {std::pair{R"(, "mesh": "../mesh.vtkhdf")", "has a 'mesh' and a 'transform'; leave out one"},
        {R"(, "temporal": true)", "--temporal is for warps by a mesh; leave it out"},
        {R"(, "resume": true)", "--resume of a warp by a transform needs --provenance; add it"}}) {
    const CommandResult result = batch({more});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find(line), std::string::npos) << result.err;
  }
  EXPECT_FALSE(exists("jobs/a.nii"));
}

/// Of a field that an earlier job makes, the defaults that it takes are known when its job starts:
/// also where there was none before, or another one.
TEST_F(FieldBatch, DecidesDefaultsWhenAJobStarts) {
  made({"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "fields.nii", "--outputs", "displacement",
        "--temporal"});
  for (const char* step : {"1", "3"}) {
    made({"warp", "volume.vtkhdf", "fields_displacement.nii", "-o",
          std::string("alone") + step + ".nii", "--steps", step});
  }
  write_text(scene / "jobs.csv",
             "volume,mesh,transform,output,steps,outputs,temporal\n"
             "volume.vtkhdf,mesh.vtkhdf,,new.nii,0:4,displacement,true\n"
             "volume.vtkhdf,mesh.vtkhdf,,w.vtkhdf,3,displacement,\n"
             "volume.vtkhdf,,new_displacement.nii,several.nii,,,\n"
             "volume.vtkhdf,,w.vtkhdf,single.nii,,,\n"
             "volume.vtkhdf,w.vtkhdf,,mesh_key.nii,,,\n");
  for (const char* jobs : {"1", "3"}) {
    for (const std::string step : {"1", "3"}) {
      made({"warp", "--batch", "jobs.csv", "--jobs", jobs, "--steps", step, "--device", "0",
            "--report", "all.json"});
      EXPECT_EQ(sha256_of_file(scene / "several.nii"),
                sha256_of_file(scene / ("alone" + step + ".nii")));
      const auto reports = nlohmann::json::parse(text_of(scene / "all.json"))["jobs"];
      for (const auto& report : reports) {
        const int job = report["job"];
        const Names expected = job < 3    ? Names{}
                               : job == 3 ? Names{"--device=0"}
                                          : Names{"--steps=" + step, "--device=0"};
        EXPECT_EQ(report.value("defaults_left_out", Names{}), expected) << report;
      }
    }
    for (const std::string& name : scene.names()) {
      if (*jobs == '1' && !name.starts_with("alone") && name != "jobs.csv" && name != "jobs" &&
          name != "volume.vtkhdf" && name != "mesh.vtkhdf") {
        fs::remove(scene / name);
      }
    }
  }
}

/// A transform that cannot be read is an error of its job, whatever the defaults.
TEST_F(FieldBatch, RunsTheOthersBesideATransformThatCannotBeRead) {
  made({"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "w.nii", "--outputs", "displacement",
        "--steps", "3"});
  fs::create_directory(scene / "folder");
  write_text(scene / "empty.nii", "");
  for (const char* transform : {"folder", "jobs.csv", "empty.nii", "none.nii"}) {
    write_text(scene / "jobs.csv", std::string("volume,transform,output\nvolume.vtkhdf,") +
                                       transform + ",one.nii\n" +
                                       "volume.vtkhdf,w_displacement.nii,two.nii\n");
    const CommandResult result =
        run_command(scene, {"warp", "--batch", "jobs.csv", "--axes", "lps"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("tetwarp: job 1: "), std::string::npos) << result.err;
    EXPECT_TRUE(fs::remove(scene / "two.nii")) << transform << result.err;
  }
}
}  // namespace
}  // namespace tetwarp::test
