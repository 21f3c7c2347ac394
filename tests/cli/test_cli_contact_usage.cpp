/// @file test_cli_contact_usage.cpp
/// `tetwarp contact`: bad arguments and bad files give one line and no output.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/contact/contact_command.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
TEST_F(ContactCommand, LeavesNothingWhenTheDiskIsFull) {
  store(column_of_points(30));

  const CommandResult result = solve({}, {.file_size_limit = 4096});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("solved.hdf5"), std::string::npos) << result.err;
  EXPECT_EQ(folder.names(), (Names{"problem.hdf5"}));
}

TEST_F(ContactCommand, ExplainsItselfWithAnExample) {
  const CommandResult result = run_command(folder, {"contact", "--help"});

  EXPECT_EQ(result.exit_code, 0);
  for (const char* words : {"tetwarp contact PROBLEM -o SOLUTION", "--law cone|pyramid",
                            "--solver auto|gs|nncg|anderson|newton", "frictionless-rows",
                            "tetwarp contact stack.hdf5 -o solved.hdf5"}) {
    EXPECT_NE(result.out.find(words), std::string::npos) << words << "\n" << result.out;
  }
}

TEST_F(ContactCommand, ExitsWithTwoOnBadUsage) {
  store(sliding_point());
  for (const Names& words : std::vector<Names>{
           {"--law", "box"},           {"--rule", "both"},      {"--solver", "lemke"},
           {"--measure", "l2"},        {"--precision", "half"}, {"--tolerance", "0"},
           {"--tolerance", "nan"},     {"--max-sweeps", "0"},   {"--max-sweeps", "1.5"},
           {"--max-seconds", "0"},     {"--max-newton", "-1"},  {"--memory", "much"},
           {"--coupling", "loose"},    {"--relaxation", "2"},   {"--inner", "0"},
           {"--recovery-speed", "-1"}, {"--threads", "-1"},     {"--threads", "100000"},
           {"--no-skip", "work"},      {"other.hdf5"},          {"--energy"}}) {
    const CommandResult result = solve(words);

    EXPECT_EQ(result.exit_code, 2) << words.back();
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find("tetwarp contact --help"), std::string::npos) << result.err;
  }
  EXPECT_EQ(run_command(folder, {"contact", "problem.hdf5"}).exit_code, 2);
  EXPECT_EQ(folder.names(), (Names{"problem.hdf5"}));
}

TEST_F(ContactCommand, RefusesTheEnergyOfALocalForm) {
  store(sliding_point());

  const CommandResult result = solve({"--energy", "--report", "report.json"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("has no masses, which --energy needs"), std::string::npos)
      << result.err;
  EXPECT_EQ(folder.names(), (Names{"problem.hdf5"}));
}

TEST_F(ContactCommand, NamesFileDatasetAndEntryOfABadProblem) {
  store(adhesive_problem());
  Hdf5Editor(folder / "problem.hdf5").dataset<double>("adhesion/area", {2}, {0.5, -0.25});

  const CommandResult result = solve();

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_TRUE(
      result.err.starts_with("tetwarp: problem.hdf5: /adhesion/area: adhesion.area[1]: -0.25"))
      << result.err;
  EXPECT_EQ(folder.names(), (Names{"problem.hdf5"}));
}

TEST(ContactFiles, AreDistinguishedFromOtherFiles) {
  const Scene scene;

  const CommandResult result =
      run_command(scene, {"contact", "volume.vtkhdf", "-o", "solved.hdf5"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("is a volume, expected a contact problem"), std::string::npos)
      << result.err;
  EXPECT_EQ(scene.names(), scene.inputs);
}

TEST_F(ContactCommand, NeverWritesOverItsInput) {
  store(sliding_point());

  const CommandResult result =
      run_command(folder, {"contact", "problem.hdf5", "-o", "./problem.hdf5"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("is also an input"), std::string::npos) << result.err;
  EXPECT_EQ(run_command(folder, {"contact", "problem.hdf5", "-o", "a", "--report", "a"}).exit_code,
            1);
  EXPECT_EQ(folder.names(), (Names{"problem.hdf5"}));
}

TEST_F(ContactCommand, RefusesARecoverySpeedThatALocalProblemCannotHave) {
  store(sliding_point());

  const CommandResult result = solve({"--recovery-speed", "0.5"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("has no offsets w, which --recovery-speed limits"), std::string::npos)
      << result.err;
  EXPECT_EQ(folder.names(), (Names{"problem.hdf5"}));
}

TEST_F(ContactCommand, CallsACutFileTruncated) {
  store(adhesive_problem());
  std::filesystem::resize_file(folder / "problem.hdf5", 4000);

  for (const CommandResult& result : {solve(), run_command(folder, {"info", "problem.hdf5"})}) {
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find("truncated or damaged HDF5 file"), std::string::npos) << result.err;
  }
}

TEST_F(ContactCommand, RefusesToEvolveWithoutAdhesion) {
  store(sliding_point());

  const CommandResult result = solve({"--evolve"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("/adhesion: is missing"), std::string::npos) << result.err;
  EXPECT_EQ(folder.names(), (Names{"problem.hdf5"}));
}
}  // namespace
}  // namespace tetwarp::test
