/// @file test_cli_batch.cpp
/// --batch: defaults, relative paths, failing jobs, collisions.
#include <gtest/gtest.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/files/sha256.hpp"
#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// A scene whose batch file is in another folder than its data, to test relative paths.
class Batch : public testing::Test {
 protected:
  Batch() { fs::create_directory(scene / "jobs"); }

  CommandResult run(const std::string& jobs, Names more = {}) {
    write_text(scene / "jobs/jobs.json", jobs);
    more.insert(more.begin(), {"warp", "--batch", "jobs/jobs.json"});
    return run_command(scene, more);
  }

  bool exists(const std::string& name) const { return fs::exists(scene / name); }

  Scene scene;
};

/// A job of the scene's files with further members, e.g. ", \"steps\": 0".
std::string job(const std::string& output, const std::string& more) {
  return R"({"volume": "../volume.vtkhdf", "mesh": "../mesh.vtkhdf", "output": ")" + output + "\"" +
         more + "}";
}

std::string batch_of(const Names& jobs) {
  std::string text;
  for (const std::string& one : jobs) text += (text.empty() ? "" : ",\n") + one;
  return "{\"jobs\": [\n" + text + "\n]}";
}

TEST_F(Batch, RunsEveryJobWithPathsFromItsFolder) {
  const CommandResult result = run(
      batch_of({job("a.vtkhdf", R"(, "steps": 0)"), job("../b.vtkhdf", R"(, "steps": "1:3")")}));

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(exists("jobs/a.vtkhdf"));
  EXPECT_TRUE(exists("b_0001.vtkhdf"));
  EXPECT_TRUE(exists("b_0002.vtkhdf"));
  EXPECT_TRUE(result.out.ends_with("\n2 done, 0 failed, 0 skipped\n")) << result.out;
}

TEST_F(Batch, TakesNumbersListsAndSwitches) {
  const CommandResult result = run(batch_of(
      {job("a.vtkhdf",
           R"(, "steps": [0], "dims": [6, 5, 4], "spacing": "4,4,4", "outputs": ["mask", "tet"],
          "array": ["density"], "temporal": true, "resume": false, "background": -5)")}));

  EXPECT_EQ(result.exit_code, 0) << result.err;
  const VolumeHeader header = read_volume_header(scene / "jobs/a.vtkhdf");
  EXPECT_EQ(header.grid.dims, (std::array<std::int64_t, 3>{6, 5, 4}));
  EXPECT_EQ(header.arrays.size(), 3u);
  EXPECT_EQ(header.times.size(), 1u);
}

TEST_F(Batch, TakesOptionsBesideItAsDefaultsThatJobsOverride) {
  const CommandResult result =
      run(batch_of({job("a.vtkhdf", ""), job("b.vtkhdf", R"(, "roi": "0:4,0:4,0:4")")}),
          {"--steps", "0", "--roi", "0:2,0:2,0:2", "--outputs", "mask"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read_volume_header(scene / "jobs/a.vtkhdf").grid.dims[0], 2);
  EXPECT_EQ(read_volume_header(scene / "jobs/b.vtkhdf").grid.dims[0], 4);
  EXPECT_EQ(read_volume_header(scene / "jobs/b.vtkhdf").arrays.size(), 2u);
}

TEST_F(Batch, ReportsAFailingJobAndRunsTheOthers) {
  const CommandResult result = run(
      batch_of({job("a.vtkhdf", R"(, "steps": 99)"), job("b.vtkhdf", R"(, "filtre": "nearest")"),
                job("c.vtkhdf", R"(, "filter": "cubical")"),
                R"({"volume": "../volume.vtkhdf", "output": "d.vtkhdf"})", "17",
                job("good.vtkhdf", R"(, "steps": 0)")}),
      {"--report", "report.json"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(exists("jobs/good.vtkhdf"));
  EXPECT_NE(result.err.find("tetwarp: job 1: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("tetwarp: job 2: jobs/jobs.json: unknown key 'filtre'; keys are"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("tetwarp: job 3: jobs/jobs.json: --filter: 'cubical'"),
            std::string::npos);
  EXPECT_NE(result.err.find("tetwarp: job 4: jobs/jobs.json: has no 'mesh'\n"), std::string::npos);
  EXPECT_NE(result.err.find("tetwarp: job 5: jobs/jobs.json: is not a JSON object\n"),
            std::string::npos);
  EXPECT_TRUE(result.out.ends_with("1 done, 5 failed, 0 skipped\n")) << result.out;
  const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
  EXPECT_EQ(report["status"], "failed");
  EXPECT_EQ(report["jobs_done"], 1);
  EXPECT_EQ(report["jobs_failed"], 5);
  EXPECT_EQ(report["jobs_skipped"], 0);
  const auto& jobs = report["jobs"];
  ASSERT_EQ(jobs.size(), 6u);
  EXPECT_EQ(jobs[1]["status"], "failed");
  EXPECT_EQ(
      jobs[1]["error"],
      "jobs/jobs.json: unknown key 'filtre'; keys are volume, mesh, transform and the options "
      "of tetwarp warp");
  EXPECT_EQ(jobs[1]["volumes"], Names{"jobs/../volume.vtkhdf"});
  EXPECT_EQ(jobs[1]["mesh"], "jobs/../mesh.vtkhdf");
  EXPECT_EQ(jobs[1]["output"], "jobs/b.vtkhdf");
  EXPECT_EQ(jobs[3]["mesh"], "");
  EXPECT_EQ(jobs[3]["output"], "jobs/d.vtkhdf");
  EXPECT_EQ(jobs[5]["status"], "done");
  EXPECT_EQ(jobs[5]["job"], 6);
  EXPECT_EQ(jobs[5]["counts"]["voxels"], 960);
}

TEST_F(Batch, RefusesOptionsOfFieldsForMeshes) {
  const CommandResult result = run(batch_of({job("a.vtkhdf", R"(, "fsl": "relative")")}));

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("--fsl is for warp fields of FSL"), std::string::npos) << result.err;
}

TEST_F(Batch, MakesTheFoldersOfItsOutputs) {
  const CommandResult result = run(batch_of(
      {job("new/deep/a.vtkhdf", ""), job("new/b.vtkhdf", R"(, "steps": 0, "report": "new/b.json")"),
       R"({"volume": ["../volume.vtkhdf", "new/b.vtkhdf"], "mesh": "../mesh.vtkhdf",
                        "output": "new/several/both", "steps": 0})"}));

  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const std::string name : {"new/deep/a_0003.vtkhdf", "new/b.vtkhdf", "new/b.json",
                                 "new/several/both/volume.vtkhdf", "new/several/both/b.vtkhdf"}) {
    EXPECT_TRUE(exists("jobs/" + name)) << name;
  }
}

TEST_F(Batch, MakesNoFolderForADryRun) {
  EXPECT_EQ(run(batch_of({job("new/a.vtkhdf", "")}), {"--dry-run"}).exit_code, 0);

  EXPECT_FALSE(exists("jobs/new"));
}

TEST_F(Batch, RefusesAFolderThatItMayNotMake) {
  if (geteuid() == 0) GTEST_SKIP() << "root can write to any folder";
  fs::create_directory(scene / "closed");
  fs::permissions(scene / "closed", fs::perms::owner_read | fs::perms::owner_exec);
  const CommandResult result = run(batch_of({job("../closed/new/a.vtkhdf", "")}));

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("no permission to write in folder"), std::string::npos) << result.err;
}

TEST_F(Batch, RefusesTwoJobsThatWriteTheSameFile) {
  const CommandResult result =
      run(batch_of({job("a.vtkhdf", ""), job("../jobs/a_0002.vtkhdf", R"(, "steps": 0)")}));

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("job 1 and job 2 both write it"), std::string::npos) << result.err;
  EXPECT_EQ(std::distance(fs::directory_iterator(scene / "jobs"), {}), 1) << "not only jobs.json";
}

TEST_F(Batch, LetsAJobUseWhatAnEarlierOneWrites) {
  const CommandResult result =
      run(batch_of({job("first.vtkhdf", R"(, "steps": 0)"),
                    R"({"volume": "first.vtkhdf", "mesh": "../mesh.vtkhdf", "steps": 1,
                        "output": "second.vtkhdf"})"}));

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(exists("jobs/second.vtkhdf"));
}

TEST_F(Batch, CountsWhatResumeSkips) {
  const std::string jobs = batch_of({job("a.vtkhdf", ""), job("b.vtkhdf", R"(, "steps": 0)")});
  EXPECT_EQ(run(jobs).exit_code, 0);
  fs::remove(scene / "jobs/b.vtkhdf");

  const CommandResult result = run(jobs, {"--resume"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.out.ends_with("1 done, 0 failed, 1 skipped\n")) << result.out;
}

/// One row per job: cells that are empty set no option, quotes hold commas.
TEST_F(Batch, ReadsCsv) {
  write_text(scene / "jobs/jobs.csv",
             "volume,mesh,output,steps,temporal,roi\r\n"
             "../volume.vtkhdf,../mesh.vtkhdf,a.vtkhdf,0,,\"0:2,0:2,0:2\"\n"
             "\n"
             "../volume.vtkhdf , ../mesh.vtkhdf,b.vtkhdf,,true,\n");
  const CommandResult result = run_command(scene, {"warp", "--batch", "jobs/jobs.csv"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read_volume_header(scene / "jobs/a.vtkhdf").grid.dims[1], 2);
  EXPECT_EQ(read_volume_header(scene / "jobs/b.vtkhdf").times.size(), 4u);
}

/// Errors in rows name the line of the file, from 1; blank lines and breaks in cells count.
TEST_F(Batch, RefusesDamagedCsvInOneLine) {
  for (const auto& [text, place] : {std::pair{"", ""},
                                    {"volume,mesh,output\n", ""},
                                    {"volume,mesh\na,b,c\n", "line 2"},
                                    {"\n\nvolume,mesh\r\n\na,\"b\nc\"\n\na,b,c\n", "line 8"},
                                    {"volume,mesh\n\n\"a,b\n", "line 3"},
                                    {"volume, volume ,mesh\na,b,c\n", "line 1"},
                                    {"\nmesh,output,filter,output\na,b,c,d\n", "line 2"}}) {
    write_text(scene / "jobs/bad.csv", text);
    const CommandResult result = run_command(scene, {"warp", "--batch", "jobs/bad.csv"});

    EXPECT_EQ(result.exit_code, 1) << text;
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_TRUE(result.err.starts_with(std::string("tetwarp: jobs/bad.csv: ") + place))
        << result.err;
  }
}

/// Of a key that is there twice neither value is dropped silently.
TEST_F(Batch, RefusesAKeyThatIsThereTwice) {
  for (const std::string key : {"volume", "mesh", "output", "filter"}) {
    const CommandResult result =
        run(batch_of({job("a.vtkhdf", R"(, "filter": "cubic", ")" + key + R"(": "nearest")")}));

    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find(key + ": stands twice"), std::string::npos) << result.err;
    EXPECT_FALSE(exists("jobs/a.vtkhdf"));
  }
}

/// A list is refused by every option of one value, and taken by those of several.
TEST_F(Batch, RefusesAListWhereOneValueIsExpected) {
  for (const std::string member :
       {R"("report": ["r", "s"])", R"("rest": ["r", "s"])", R"("displacement": ["u", "v"])",
        R"("filter": ["cubic", "nearest"])", R"("background": [1, 2])", R"("grid": ["a", "b"])"}) {
    const CommandResult result = run(batch_of({job("a.vtkhdf", ", " + member)}));

    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("holds a list of 2, expected one value"), std::string::npos)
        << result.err;
    EXPECT_EQ(std::distance(fs::directory_iterator(scene / "jobs"), {}), 1) << member;
  }
  const CommandResult outputs =
      run(R"({"jobs": [{"volume": "v", "mesh": "m", "output": ["a", "b"]}]})");
  EXPECT_NE(outputs.err.find("'output' holds a list of 2"), std::string::npos) << outputs.err;
  EXPECT_EQ(run(batch_of({job("a.vtkhdf", R"(, "filter": ["cubic"], "steps": [0, 1])")})).exit_code,
            0);
}

TEST_F(Batch, MakesAJobOfEachFileThatAPatternMatches) {
  fs::copy(scene / "volume.vtkhdf", scene / "jobs/ct_10.vtkhdf");
  fs::copy(scene / "volume.vtkhdf", scene / "jobs/ct_9.vtkhdf");
  const CommandResult result =
      run(R"({"jobs": [{"volume": "ct_*.vtkhdf", "mesh": "../mesh.vtkhdf", "steps": 0,
                        "output": "out/warped_*.vtkhdf"}]})",
          {"--report", "report.json"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(exists("jobs/out/warped_9.vtkhdf"));
  EXPECT_TRUE(exists("jobs/out/warped_10.vtkhdf"));
  const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
  ASSERT_EQ(report["jobs"].size(), 2u);
  EXPECT_EQ(report["jobs"][0]["output"], "jobs/out/warped_9.vtkhdf");
  EXPECT_EQ(run(R"({"jobs": [{"volume": "no_*.vtkhdf", "mesh": "m", "output": "*"}]})").exit_code,
            1);
}

/// The files are those of jobs one after the other; a job that fails does not stop the others.
TEST_F(Batch, RunsJobsBesideEachOther) {
  const std::string jobs =
      batch_of({job("a.vtkhdf", R"(, "steps": 0)"), job("b.vtkhdf", R"(, "steps": 99)"),
                job("c.vtkhdf", R"(, "steps": 1)"), job("d.vtkhdf", R"(, "filtre": "nearest")")});
  EXPECT_EQ(run(jobs).exit_code, 1);
  const std::string a = text_of(scene / "jobs/a.vtkhdf"), c = text_of(scene / "jobs/c.vtkhdf");
  fs::remove(scene / "jobs/a.vtkhdf");
  fs::remove(scene / "jobs/c.vtkhdf");

  const CommandResult result = run(jobs, {"--jobs", "3", "--report", "report.json"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.out.ends_with("2 done, 2 failed, 0 skipped\n")) << result.out;
  EXPECT_NE(result.err.find("4 jobs, up to 3 at a time, take up to "), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("tetwarp: job 2: "), std::string::npos) << result.err;
  EXPECT_EQ(text_of(scene / "jobs/a.vtkhdf"), a);
  EXPECT_EQ(text_of(scene / "jobs/c.vtkhdf"), c);
  const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
  EXPECT_EQ(report["status"], "failed");
  EXPECT_EQ(report["jobs_done"], 2);
  ASSERT_EQ(report["jobs"].size(), 4u);
  for (const auto& one : report["jobs"]) {
    EXPECT_EQ(one["status"], one["job"] == 1 || one["job"] == 3 ? "done" : "failed") << one;
  }
  EXPECT_TRUE(
      run(jobs, {"--jobs", "2", "--resume"}).out.ends_with("0 done, 2 failed, 2 skipped\n"));
  EXPECT_EQ(
      run_command(scene, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "x.vtkhdf", "--jobs", "2"})
          .exit_code,
      2);
}

/// Input and output are named with the hash that sha256sum prints.
TEST_F(Batch, WritesWhatOutputsWereMadeFrom) {
  const CommandResult result =
      run(batch_of({job("a.vtkhdf", R"(, "steps": 0, "filter": "nearest")")}), {"--provenance"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto facts = nlohmann::json::parse(text_of(scene / "jobs/a.vtkhdf.json"));
  EXPECT_EQ(facts["options"]["filter"], "nearest");
  EXPECT_EQ(facts["backend"].is_string(), true);
  ASSERT_EQ(facts["inputs"].size(), 2u);
  EXPECT_EQ(facts["inputs"][0]["role"], "volume");
  EXPECT_EQ(facts["inputs"][1]["role"], "mesh");
  EXPECT_EQ(facts["inputs"][1]["sha256"], sha256_of_file(scene / "mesh.vtkhdf"));
  EXPECT_EQ(facts["output"]["sha256"], sha256_of_file(scene / "jobs/a.vtkhdf"));
}

/// NRRD files have no fingerprint: the files of --provenance tell what is up to date.
TEST_F(Batch, SkipsJobsWhoseProvenanceAgrees) {
  const std::string jobs = batch_of({job("a.nrrd", R"(, "steps": 0)"),
                                     job("b.vtkhdf", R"(, "filter": "nearest", "steps": "0:2")")});
  const auto ends = [&](const std::string& list, const std::string& counts, Names more = {}) {
    more.insert(more.end(), {"--resume", "--provenance"});
    const CommandResult result = run(list, more);
    return result.exit_code == 0 && result.out.ends_with(counts + "\n") ? ""
                                                                        : result.out + result.err;
  };
  EXPECT_EQ(run(jobs, {"--provenance"}).exit_code, 0);
  const std::string whole = text_of(scene / "jobs/a.nrrd");

  EXPECT_EQ(ends(jobs, "0 done, 0 failed, 2 skipped", {"--threads", "1"}), "");
  EXPECT_EQ(ends(jobs, "0 done, 0 failed, 2 skipped", {"--jobs", "2"}), "");
  write_text(scene / "jobs/a.nrrd", whole.substr(0, whole.size() - 1));
  EXPECT_EQ(ends(jobs, "1 done, 0 failed, 1 skipped"), "");
  EXPECT_EQ(text_of(scene / "jobs/a.nrrd"), whole);
  std::string other = whole;
  other.back() = static_cast<char>(other.back() + 1);
  write_text(scene / "jobs/a.nrrd", other);
  EXPECT_EQ(ends(jobs, "1 done, 0 failed, 1 skipped"), "");
  EXPECT_EQ(text_of(scene / "jobs/a.nrrd"), whole);
  fs::remove(scene / "jobs/b_0001.vtkhdf");
  EXPECT_EQ(ends(jobs, "1 done, 0 failed, 1 skipped"), "");
  write_text(scene / "jobs/a.nrrd.json", "{\"output\": 3}");
  EXPECT_EQ(ends(jobs, "1 done, 0 failed, 1 skipped"), "");
  EXPECT_EQ(ends(jobs, "2 done, 0 failed, 0 skipped", {"--background", "3"}), "");
  EXPECT_EQ(ends(jobs, "0 done, 0 failed, 2 skipped", {"--background", "3"}), "");
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({0, 2, 1, 3}), {0, 0.5, 1, 1.5});
  EXPECT_EQ(ends(jobs, "2 done, 0 failed, 0 skipped", {"--background", "3"}), "");
}

/// The samples of a pair count, of outputs and of inputs.
TEST_F(Batch, ComparesSamplesBesideTheirHeader) {
  const std::string first = batch_of({job("a.mhd", R"(, "steps": 0)")});
  const std::string both = batch_of(
      {job("a.mhd", R"(, "steps": 0)"),
       R"({"volume": "a.mhd", "mesh": "../mesh.vtkhdf", "output": "b.nrrd", "steps": 1})"});
  EXPECT_EQ(run(first, {"--provenance"}).exit_code, 0);
  EXPECT_EQ(run(both, {"--provenance"}).exit_code, 0);
  const auto counts = [&] {
    const std::string out = run(both, {"--provenance", "--resume"}).out;
    return out.substr(out.rfind('\n', out.size() - 2) + 1);
  };
  const std::string whole = text_of(scene / "jobs/a.raw");

  EXPECT_EQ(counts(), "0 done, 0 failed, 2 skipped\n");
  write_text(scene / "jobs/a.raw", whole.substr(0, whole.size() / 2) + whole);
  EXPECT_EQ(counts(), "1 done, 0 failed, 1 skipped\n");
  EXPECT_EQ(text_of(scene / "jobs/a.raw"), whole);
  std::string facts = text_of(scene / "jobs/b.nrrd.json");
  const std::string hash = sha256_of_file(scene / "jobs/a.raw");
  ASSERT_NE(facts.find(hash), std::string::npos);
  write_text(scene / "jobs/b.nrrd.json",
             facts.replace(facts.find(hash), hash.size(), std::string(hash.size(), '0')));
  EXPECT_EQ(counts(), "1 done, 0 failed, 1 skipped\n");
}

TEST_F(Batch, NamesThePlaceWhereTheFileIsNoJson) {
  const CommandResult result = run("{\"jobs\": [\n  {\"volume\": }\n]}");

  EXPECT_EQ(result.exit_code, 1);
  const std::string line = "tetwarp: jobs/jobs.json: line 2, column 14: is not valid JSON; correct";
  EXPECT_TRUE(result.err.starts_with(line)) << result.err;
}

TEST_F(Batch, RefusesAFileWithoutJobs) {
  for (const std::string text : {"", "[]", "{}", R"({"jobs": {}})", R"({"jobs": []})",
                                 R"({"jobs": [{}], "task": 1})", "\xff\xfe"}) {
    const CommandResult result = run(text);

    EXPECT_EQ(result.exit_code, 1) << text;
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
  }
  EXPECT_EQ(run_command(scene, {"warp", "--batch", "none.json"}).exit_code, 1);
}
}  // namespace
}  // namespace tetwarp::test
