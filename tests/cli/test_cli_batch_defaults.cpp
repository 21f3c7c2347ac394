/// @file test_cli_batch_defaults.cpp
/// Defaults of a batch that stand against options and files of a job.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;
using Json = nlohmann::json;

const Json none = Json::object();

Json one_key(const char* key, const Json& value) {
  Json members = none;
  members[key] = value;
  return members;
}

class BatchDefaults : public testing::Test {
 protected:
  /// Runs jobs of volume.vtkhdf by step 1 of mesh.vtkhdf with outputs 0.nii and so on.
  /// @param jobs  more members of each
  CommandResult run(const std::vector<Json>& jobs, Names defaults) const {
    Json list = Json::array();
    for (const Json& more : jobs) {
      list.push_back({{"volume", "volume.vtkhdf"},
                      {"mesh", "mesh.vtkhdf"},
                      {"steps", 1},
                      {"output", std::to_string(list.size()) + ".nii"}});
      list.back().update(more);
    }
    write_text(scene / "jobs.json", Json{{"jobs", list}}.dump());
    defaults.insert(defaults.begin(), {"warp", "--batch", "jobs.json"});
    return run_command(scene, defaults);
  }

  /// Defaults that each job of all.json left out.
  std::vector<Names> left_out() const {
    std::vector<Names> all;
    const auto report = Json::parse(text_of(scene / "all.json"));
    for (const auto& job : report["jobs"]) all.push_back(job.value("defaults_left_out", Names{}));
    return all;
  }

  Scene scene;
};

/// A default that cannot stand beside what a job says is left out and reported, and refused where
/// no job takes it.
TEST_F(BatchDefaults, YieldToWhatAJobSays) {
  fs::create_directory(scene / "folder");  // of no images: an error of the job that takes it
  struct Case {
    Json job, taker;
    Names defaults;
    std::string left_out, reason;
  };
  const std::string device = "--device is of cuda, --backend is ";
  const std::string like = "--like-series is of the folder of DICOM images that --like names; add ";
  const Json folder = one_key("like", "folder");
  for (const Case& one : {
           Case{one_key("backend", "cpu"), none, {"--device", "0"}, "--device=0", device + "cpu; "},
           {one_key("backend", "reference"), none, {"--device", "0"}, "--device=0", device},
           {one_key("device", 0), none, {"--backend", "cpu"}, "--backend=cpu", device + "cpu; "},
           {none, folder, {"--like-series", "1.2"}, "--like-series=1.2", like},
           {one_key("like", "volume.vtkhdf"),
            folder,
            {"--like-series", "1.2"},
            "--like-series=1.2",
            like},
           {one_key("grid", "bounds"),
            none,
            {"--like", "folder", "--like-series", "1.2"},
            "--like-series=1.2",
            like},
           {none,
            one_key("volume", "folder"),
            {"--series", "1.2"},
            "--series=1.2",
            "--series is for folders of DICOM images; leave it out"},
       }) {
    const CommandResult refused = run({one.job, one.job}, one.defaults);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_TRUE(refused.has_one_line_error()) << refused.err;
    EXPECT_NE(refused.err.find("jobs.json: no job takes a default: " + one.reason),
              std::string::npos)
        << refused.err;
    EXPECT_FALSE(fs::exists(scene / "0.nii"));

    Names defaults = one.defaults;
    defaults.insert(defaults.end(), {"--report", "all.json"});
    const CommandResult taken = run({one.job, one.taker}, defaults);
    EXPECT_EQ(left_out(), (std::vector<Names>{{one.left_out}, {}})) << taken.err;
    EXPECT_TRUE(fs::remove(scene / "0.nii")) << taken.err;
  }
}

/// A job that chooses its grid by one of the two names takes no default of the other one.
TEST_F(BatchDefaults, OfGridsYieldToBothNames) {
  const Volume small = make_volume({{3, 4, 5}}, PixelType::uint8, 1, "any");
  write_volumes(scene / "small.vtkhdf", {&small});
  const CommandResult result =
      run({one_key("grid", "bounds"), one_key("grid", "same"), one_key("steps", 0)},
          {"--like", "small.vtkhdf"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read_volume_header(scene / "1.nii").grid.dims[0], 12);
  EXPECT_EQ(read_volume_header(scene / "2.nii").grid.dims[0], 3);
  EXPECT_EQ(run({one_key("like", "small.vtkhdf"), none}, {"--grid", "bounds"}).exit_code, 0);
  EXPECT_EQ(read_volume_header(scene / "0.nii").grid.dims[0], 3);
}

/// The count of folded voxels is for a report: of the warp, of its job, or of the batch.
TEST_F(BatchDefaults, CountFoldedVoxelsForAReport) {
  const CommandResult alone =
      run_command(scene, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "x.nii", "--count-folded"});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_NE(alone.err.find("--count-folded: needs --report"), std::string::npos) << alone.err;
  const CommandResult refused = run({none, none}, {"--count-folded"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("no job takes a default: --count-folded needs --report"),
            std::string::npos)
      << refused.err;
  const Json counts = one_key("count-folded", true), reports = one_key("report", "own.json");
  Json both = counts;
  both.update(reports);
  const CommandResult mixed = run({counts, both}, {});
  EXPECT_EQ(mixed.exit_code, 1);
  EXPECT_NE(mixed.err.find("job 1: jobs.json: --count-folded: needs --report"), std::string::npos)
      << mixed.err;
  EXPECT_FALSE(fs::exists(scene / "0.nii"));
  EXPECT_TRUE(fs::exists(scene / "1.nii") && fs::exists(scene / "own.json"));
  EXPECT_EQ(run({none, reports}, {"--count-folded"}).exit_code, 0);
  for (const char* jobs : {"1", "2"}) {
    EXPECT_EQ(run({counts, both}, {"--report", "all.json", "--jobs", jobs}).exit_code, 0);
    EXPECT_EQ(run({none, none}, {"--report", "all.json", "--count-folded"}).exit_code, 0);
    EXPECT_EQ(left_out(), (std::vector<Names>(2)));
  }
}
}  // namespace
}  // namespace tetwarp::test
