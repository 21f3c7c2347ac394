/// @file test_cli_batch_order.cpp
/// Jobs of a batch beside each other do and say what they do one after the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "io/files/sha256.hpp"
#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// One row of a batch in CSV.
struct Row {
  std::string volume, deformation, output, background = "0";
};

std::string csv_of(const std::vector<Row>& rows) {
  std::string text = "volume,mesh,output,background\n";
  for (const Row& row : rows) {
    text += row.volume + "," + row.deformation + "," + row.output + "," + row.background + "\n";
  }
  return text;
}

/// Lines without seconds, sorted: jobs beside each other end in any order.
Names lines_of(const std::string& text) {
  static const std::regex seconds("[0-9.]+ s on");
  std::istringstream stream(std::regex_replace(text, seconds, "s on"));
  Names lines;
  for (std::string line; std::getline(stream, line);) {
    if (line.find("at a time, take up to") == std::string::npos) lines.push_back(line);
  }
  std::ranges::sort(lines);
  return lines;
}

/// "job N: " of the jobs that are not run.
Names refused_jobs(const std::string& text) {
  static const std::regex line("tetwarp: (job [0-9]+: )is not run: job 1 failed, which writes");
  Names jobs;
  for (std::sregex_iterator at(text.begin(), text.end(), line), end; at != end; ++at) {
    jobs.push_back((*at)[1]);
  }
  return jobs;
}

/// A scene whose mesh has one step, shifted by one voxel.
class BatchOrder : public testing::Test {
 protected:
  BatchOrder() {
    write_mesh(scene / "one.vtkhdf", box_mesh(), shifts({1}));
    write_text(scene / "one.tfm",
               "#Insight Transform File V1.0\n#Transform 0\nTransform: "
               "TranslationTransform_double_3_3\nParameters: 2 0 0\nFixedParameters: \n");
    write_source(0);
  }

  /// volume.nii with all samples raised.
  void write_source(float raised) const {
    Volume volume = ramp_volume<float>();
    for (float& sample : volume.samples<float>()) sample += raised;
    write_nifti(scene / "volume.nii", volume);
  }

  CommandResult run(const std::vector<Row>& rows, Names more) const {
    write_text(scene / "jobs.csv", csv_of(rows));
    more.insert(more.begin(), {"warp", "--batch", "jobs.csv"});
    return run_command(scene, more);
  }

  /// Contents of the files of a kind.
  std::map<std::string, std::string> files(const std::string& extension) const {
    std::map<std::string, std::string> found;
    for (const std::string& name : scene.names()) {
      if (fs::path(name).extension() == extension) found[name] = text_of(scene / name);
    }
    return found;
  }
  void restore(const std::map<std::string, std::string>& files) const {
    for (const auto& [name, text] : files) write_text(scene / name, text);
  }

  /// Warnings and notes of each job in a report.
  std::map<int, std::pair<Names, Names>> notes_of(const std::string& report) const {
    std::map<int, std::pair<Names, Names>> notes;
    const auto jobs = nlohmann::json::parse(text_of(scene / report))["jobs"];
    for (const auto& job : jobs) {
      notes[job["job"]] = {job.value("warnings", Names{}), job.value("notes", Names{})};
    }
    return notes;
  }

  Scene scene;
};

/// Of random batches that are run again after their input has changed: jobs read the source, what
/// earlier jobs write, and what later jobs overwrite.
TEST_F(BatchOrder, WritesWhatOneAfterTheOtherWrites) {
  std::mt19937 random(7);
  for (int batch = 0; batch < 3; ++batch) {
    constexpr std::size_t count = 6;
    std::vector<Row> rows;
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t source = random() % (count + 1);
      rows.push_back(
          {source == count || source == j ? "volume.nii" : "v" + std::to_string(source) + ".nii",
           random() % 2 == 0 ? "one.vtkhdf" : "one.tfm", "v" + std::to_string(j) + ".nii",
           std::to_string(j)});
    }
    write_source(0);
    for (std::size_t j = 0; j < count; ++j) {
      fs::copy(scene / "volume.nii", scene / rows[j].output, fs::copy_options::overwrite_existing);
    }
    EXPECT_EQ(run(rows, {"--provenance"}).exit_code, 0);
    const auto before = files(".nii"), facts = files(".json");
    write_source(1000);
    const std::string source = text_of(scene / "volume.nii");
    EXPECT_EQ(run(rows, {"--provenance"}).exit_code, 0);
    const auto expected = files(".nii");

    for (const Names& options : {Names{}, {"--provenance"}, {"--provenance", "--resume"}}) {
      restore(before);
      restore(facts);
      write_text(scene / "volume.nii", source);
      Names words = options;
      words.insert(words.end(), {"--jobs", "4"});
      EXPECT_EQ(run(rows, words).exit_code, 0);

      EXPECT_EQ(files(".nii") == expected, true) << csv_of(rows);
    }
  }
}

/// The file beside an output has the hash of the input as it was read, also where a later job
/// overwrites it.
TEST_F(BatchOrder, RemembersTheInputThatWasRead) {
  write_source(5);
  fs::copy(scene / "volume.nii", scene / "x.nii");
  const std::string hash = sha256_of_file(scene / "x.nii");
  for (const char* jobs : {"1", "2"}) {
    fs::copy(scene / "volume.nii", scene / "x.nii", fs::copy_options::overwrite_existing);
    const CommandResult result =
        run({{"x.nii", "one.vtkhdf", "y.nii"}, {"volume.nii", "one.tfm", "x.nii"}},
            {"--provenance", "--jobs", jobs});

    EXPECT_EQ(result.exit_code, 0) << result.err;
    const auto facts = nlohmann::json::parse(text_of(scene / "y.nii.json"));
    EXPECT_EQ(facts["inputs"][0]["sha256"], hash);
    EXPECT_NE(sha256_of_file(scene / "x.nii"), hash);
  }
}

/// Warnings, what is left out, what a transform was taken for, totals and errors: the same lines.
TEST_F(BatchOrder, SaysWhatOneAfterTheOtherSays) {
  write_nifti(scene / "whole.nii", ramp_volume<std::int16_t>());
  std::string image = text_of(scene / "whole.nii");
  image[39] = 57;  // dim_info
  write_text(scene / "whole.nii", image);
  Mesh odd = box_mesh();
  for (Point3& node : odd.rest_positions) node[0] = 0.7 * node[0] + 5.1;
  write_mesh(scene / "still.vtkhdf", odd);
  const std::vector<Row> rows{{"whole.nii", "still.vtkhdf", "a.nii"},
                              {"whole.nii", "one.tfm", "b.nii"},
                              {"volume.vtkhdf", "none.vtkhdf", "c.nii"},
                              {"c.nii", "one.vtkhdf", "d.nii"},
                              {"d.nii", "one.tfm", "e.nii"}};
  for (const Names& options : {Names{}, {"--intensity", "conservative"}, {"--quiet"}}) {
    Names one = options, beside = options;
    one.insert(one.end(), {"--report", "one.json"});
    beside.insert(beside.end(), {"--report", "beside.json", "--jobs", "3"});
    const CommandResult alone = run(rows, one);
    const CommandResult result = run(rows, beside);

    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(alone.exit_code, 1);
    EXPECT_EQ(lines_of(result.out), lines_of(alone.out));
    EXPECT_EQ(lines_of(result.err), lines_of(alone.err));
    EXPECT_NE(alone.err.find("job 4: is not run: job 3 failed, which writes its input '"),
              std::string::npos)
        << alone.err;
    const auto notes = notes_of("one.json");
    EXPECT_EQ(notes_of("beside.json"), notes);
    EXPECT_EQ(notes.at(2).second, Names{"whole.nii: left out: dim_info"});
    if (options == Names{"--quiet"}) continue;
    EXPECT_NE(alone.err.find("tetwarp: job 2: whole.nii: left out: dim_info\n"), std::string::npos)
        << alone.err;
    EXPECT_NE(alone.err.find("tetwarp: job 1: warning: still.vtkhdf: "), std::string::npos);
    EXPECT_EQ(alone.err.find("tetwarp: job 1: conservative: rounding") == std::string::npos,
              options.empty());
    EXPECT_NE(alone.out.find("job 2: 12 x 10 x 8 voxels by affine transform"), std::string::npos);
  }
}

/// What a failed job may have been to write is not read by later jobs; files of other names are,
/// though their names begin alike.
TEST_F(BatchOrder, RefusesInputsThatAFailedJobWrites) {
  constexpr const char* unplanned = "none.vtkhdf";  // a mesh that is missing
  for (const std::string stem : {"ct", "v1"}) {
    for (const bool has_error : {false, true}) {
      // An array of a job with an error may have any name.
      const std::vector<std::pair<std::string, bool>> inputs{
          {".nii", true},         {"_0000.nii", true},      {"_12345.nii", true},
          {"_mask.nii", true},    {"_0003_mask.nii", true}, {"_left.nii", has_error},
          {"_2.nii", false},      {"_001.nii", false},      {"0.nii", false},
          {"_0000.nii.gz", false}};
      std::vector<Row> rows{{"volume.nii", has_error ? "mesh.vtkhdf" : unplanned, stem + ".nii",
                             has_error ? "none" : "0"}};
      Names refused;
      for (const auto& [end, is_written] : inputs) {
        Volume volume = ramp_volume<float>();
        write_nifti(scene / (stem + end), volume);
        rows.push_back({stem + end, "one.vtkhdf", "o" + std::to_string(rows.size()) + ".nii"});
        if (is_written) refused.push_back("job " + std::to_string(rows.size()) + ": ");
      }
      const CommandResult alone = run(rows, {"--outputs", "mask"});

      EXPECT_EQ(refused_jobs(alone.err), refused) << alone.err;
      const CommandResult beside = run(rows, {"--outputs", "mask", "--jobs", "3"});
      EXPECT_EQ(lines_of(beside.err), lines_of(alone.err));
    }
  }
}

/// Of several volumes the outputs have their names, in a folder.
TEST_F(BatchOrder, RefusesInputsInTheFolderOfAFailedJob) {
  fs::create_directory(scene / "out");
  write_nifti(scene / "ct.nii", ramp_volume<float>());
  for (const char* background : {"0", "none"}) {
    std::vector<Row> rows{{"volume.nii;ct.nii", "none.vtkhdf", "out", background}};
    for (const char* input : {"out/ct.nii", "out/ct_0001.nii", "out/ct_2.nii", "out/ct2.nii"}) {
      write_nifti(scene / input, ramp_volume<float>());
      rows.push_back({input, "one.vtkhdf", "o" + std::to_string(rows.size()) + ".nii"});
    }
    const CommandResult result = run(rows, {});

    EXPECT_EQ(refused_jobs(result.err), (Names{"job 2: ", "job 3: "})) << result.err;
  }
}
}  // namespace
}  // namespace tetwarp::test
