/// @file test_cli_simulate_ends.cpp
/// `tetwarp simulate`: interrupted and killed runs, exit codes, bad input.
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <tetwarp/io.hpp>
#include <utility>
#include <vector>

#include "tests/support/h5_numbers.hpp"
#include "tests/support/simulate_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// Waits for four writes to a file, which takes some seconds, at most for a minute.
/// @returns whether they came
bool is_written(const fs::path& file) {
  std::error_code missing;
  fs::file_time_type last = fs::last_write_time(file, missing);
  int writes = 0;
  for (int tries = 0; tries < 1200 && writes < 4; ++tries) {
    usleep(50'000);
    const fs::file_time_type time = fs::last_write_time(file, missing);
    if (missing || time == last) continue;
    last = time;
    ++writes;
  }
  return writes == 4;
}

TEST(Simulate, LeavesReadableFilesWhenInterrupted) {
  const SimulateScene scene;
  RunningCommand command(scene, {"simulate", "scene.json", "-o", "out", "--steps", "100000000",
                                 "--checkpoint", "state"});
  const std::string series = scene.in("out", "series.h5");
  ASSERT_TRUE(is_written(scene.in("out", "beam.vtkhdf")));
  const auto start = std::chrono::steady_clock::now();

  kill(command.process(), SIGINT);
  const CommandResult result = command.wait();

  EXPECT_EQ(result.exit_code, 130);
  EXPECT_EQ(result.err, "tetwarp: interrupted, stopping\n");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3));
  const std::size_t rows = h5_numbers(series, "time").size();
  EXPECT_GT(rows, 1u);
  EXPECT_EQ(h5_numbers(series, "bodies/beam/support_force").size(), 3 * rows);
  EXPECT_GT(MeshReader(scene.in("out", "beam.vtkhdf")).header().times.size(), 1u);
  const auto report = nlohmann::json::parse(text_of(scene.in("out", "report.json")));
  EXPECT_EQ(report["status"], "interrupted");
  EXPECT_EQ(report["steps_done"], rows - 1);
  EXPECT_TRUE(fs::exists(scene / "state"));
}

/// A load beyond the range of numbers acts from the sixth step on.
TEST(Simulate, LeavesAllStepsBeforeOneThatFails) {
  const SimulateScene scene;
  std::string text = small_scene;
  text.insert(
      text.find("\"output\""),
      R"("loads": [{"load": "ball", "select": "all", "force": [0, 0, 1e300], "from": 0.055}],
                 )");
  write_text(scene / "scene.json", text);

  const CommandResult result = scene.simulate({"-o", "out", "--checkpoint", "state"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("scene.json: step 5: bodies[1] 'ball'"), std::string::npos)
      << result.err;
  const auto report = nlohmann::json::parse(text_of(scene.in("out", "report.json")));
  EXPECT_EQ(report["status"], "failed");
  EXPECT_EQ(report["steps_done"], 5);
  EXPECT_NE(result.err.find(report["error"].get<std::string>()), std::string::npos);
  EXPECT_EQ(h5_numbers(scene.in("out", "series.h5"), "time").size(), 6u);

  // The checkpoint is the state before: the same step fails when the run goes on from there.
  const CommandResult again = scene.simulate({"-o", "out", "--restart", "state"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.err.find("step 5: "), std::string::npos) << again.err;
  EXPECT_EQ(h5_numbers(scene.in("out", "series.h5"), "time").size(), 6u);
}

/// A process that is killed between two writes leaves what it has flushed.
TEST(Simulate, LeavesReadableFilesWhenKilled) {
  const SimulateScene scene;
  RunningCommand command(scene, {"simulate", "scene.json", "-o", "out", "--steps", "100000000"});
  ASSERT_TRUE(is_written(scene.in("out", "beam.vtkhdf")));

  kill(command.process(), SIGKILL);
  EXPECT_EQ(command.wait().exit_code, 137);

  EXPECT_GT(h5_numbers(scene.in("out", "series.h5"), "time").size(), 1u);
  EXPECT_GT(h5_numbers(scene.in("out", "beam.vtkhdf"), "VTKHDF/Steps/Values").size(), 1u);
}

/// Everything that a checkpoint continues is in the files when it is written.
TEST(Simulate, GoesOnInItsFilesAfterItWasKilled) {
  const SimulateScene scene;
  const Names words{
      "simulate", "scene.json",         "-o", "out", "--steps", "100000000", "--checkpoint",
      "state",    "--checkpoint-every", "7"};
  {
    RunningCommand command(scene, words);
    ASSERT_TRUE(is_written(scene / "state"));
    kill(command.process(), SIGKILL);
    EXPECT_EQ(command.wait().exit_code, 137);
  }
  Names again = words;
  again.insert(again.end(), {"--restart", "state"});
  RunningCommand command(scene, again);
  ASSERT_TRUE(is_written(scene.in("out", "beam.vtkhdf")));
  kill(command.process(), SIGINT);
  EXPECT_EQ(command.wait().exit_code, 130);

  const std::vector<double> times = h5_numbers(scene.in("out", "series.h5"), "time");
  EXPECT_GT(times.size(), 7u);
  for (std::size_t n = 0; n < times.size(); ++n) {
    ASSERT_NEAR(times[n], 0.01 * static_cast<double>(n), 1e-9 * static_cast<double>(n));
  }
  const std::vector<double> frames =
      h5_numbers(scene.in("out", "beam.vtkhdf"), "VTKHDF/Steps/Values");
  EXPECT_GT(frames.size(), 2u);
  for (std::size_t n = 0; n + 1 < frames.size(); ++n) {
    ASSERT_NEAR(frames[n], 0.05 * static_cast<double>(n), 1e-9 * static_cast<double>(n));
  }
}

TEST(Simulate, ExitsWith3AfterAStepAboveItsTolerance) {
  const SimulateScene scene;

  const CommandResult result =
      scene.simulate({"-o", "out", "--steps", "2", "--max-iterations", "1"});

  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_EQ(h5_numbers(scene.in("out", "series.h5"), "converged"), (std::vector<double>{1, 0, 0}));
}

TEST(Simulate, ListsAndPrintsItsScenes) {
  const SimulateScene scene;

  const CommandResult list = run_command(scene, {"simulate", "--scene", "list"});
  const CommandResult chain = run_command(scene, {"simulate", "--scene", "chain", "--print"});

  EXPECT_EQ(list.exit_code, 0);
  EXPECT_NE(list.out.find("chain\n"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(chain.out)["tetwarp_scene"], 1);
}

TEST(SimulateErrors, AreOneLineAndWriteNothing) {
  const SimulateScene scene;
  write_text(scene / "broken.json", R"({"tetwarp_scene": 1, "time_step": -1})");
  write_text(scene / "state", "no checkpoint");
  const std::vector<std::pair<Names, std::string>> cases{
      {{"broken.json", "-o", "out"}, "broken.json"},
      {{"missing.json", "-o", "out"}, "missing.json"},
      {{"scene.json", "-o", "out", "--warp", "beam"}, "beam"},
      {{"scene.json", "-o", "out", "--warp", "nobody"}, "nobody"},
      {{"scene.json", "-o", "out", "--restart", "state"}, "state"},
      {{"scene.json", "-o", "out", "--restart", "missing"}, "missing"},
      {{"scene.json", "-o", "missing/deeper/out", "--film", "state/film.gif"}, "film.gif"},
      {{"scene.json", "-o", "scene.json"}, "'scene.json' is not a folder"},
      {{"scene.json", "-o", "out", "--restart", "."}, "name a file that --checkpoint wrote"},
      {{"scene.json", "-o", "out", "--checkpoint", "out/beam.vtkhdf"}, "another name for --check"},
      {{"scene.json", "-o", "out", "--report", "out/series.h5"}, "is the series of the run"},
      {{"scene.json", "-o", "out", "--report", "x", "--checkpoint", "x"}, "file of --report"},
      {{"--scene", "nobody", "-o", "out"}, "nobody"}};
  for (const auto& [words, named] : cases) {
    Names all = words;
    all.insert(all.begin(), "simulate");

    const CommandResult result = run_command(scene, all);

    EXPECT_EQ(result.exit_code, 1) << named;
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find(named), std::string::npos) << result.err;
    EXPECT_EQ(scene.names(), (Names{"broken.json", "scene.json", "state"})) << named;
  }
}

/// The series is not shortened when a mesh beside it is of another scene.
TEST(SimulateErrors, LeaveTheFolderOfAnotherRunAsItIs) {
  const SimulateScene scene;
  ASSERT_EQ(scene.simulate({"-o", "out", "--steps", "4", "--checkpoint", "state"}).exit_code, 0);
  ASSERT_EQ(scene.simulate({"-o", "out", "--steps", "8"}).exit_code, 0);
  fs::copy_file(scene.in("out", "ball.surface.vtkhdf"), scene.in("out", "beam.vtkhdf"),
                fs::copy_options::overwrite_existing);

  const CommandResult result = scene.simulate({"-o", "out", "--restart", "state"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("beam.vtkhdf"), std::string::npos) << result.err;
  EXPECT_EQ(h5_numbers(scene.in("out", "series.h5"), "time").size(), 9u);
}

/// Of which steps before the checkpoint would have other fields than later ones.
TEST(SimulateErrors, RefuseOtherFieldsInTheFolderThatGoesOn) {
  const SimulateScene scene;
  nlohmann::json with_fields = nlohmann::json::parse(small_scene);
  with_fields["output"]["fields"] = {"velocity"};
  write_text(scene / "scene.json", with_fields.dump());
  ASSERT_EQ(scene.simulate({"-o", "out", "--steps", "4", "--checkpoint", "state"}).exit_code, 0);
  write_text(scene / "scene.json", small_scene);

  const CommandResult result = scene.simulate({"-o", "out", "--restart", "state", "--steps", "6"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("has other fields"), std::string::npos) << result.err;
  EXPECT_EQ(h5_numbers(scene.in("out", "series.h5"), "time").size(), 5u);
}

TEST(SimulateErrors, OfUsageExitWith2) {
  const SimulateScene scene;
  const std::vector<Names> cases{
      {"scene.json"},
      {"-o", "out"},
      {"scene.json", "--scene", "chain", "-o", "out"},
      {"scene.json", "-o", "out", "--checkpoint-every", "3"},
      {"scene.json", "-o", "out", "--film", "film.avi"},
      {"scene.json", "-o", "out", "--camera", "1,2,3"},
      {"scene.json", "-o", "out", "--camera", "inside"},
      {"scene.json", "-o", "out", "--picture", "--camera", "1,2,3,4,5,x"},
      {"scene.json", "-o", "out", "--picture", "--camera", "1,2,3,4,5,inf"},
      {"scene.json", "-o", "out", "--picture", "--camera", "1,1,1,1,1,1"},
      {"scene.json", "-o", "out", "--backend", "abacus"}};
  for (const Names& words : cases) {
    Names all = words;
    all.insert(all.begin(), "simulate");
    const CommandResult result = run_command(scene, all);
    EXPECT_EQ(result.exit_code, 2) << words.back() << ": " << result.err;
    EXPECT_EQ(scene.names(), (Names{"scene.json"}));
  }
}
}  // namespace
}  // namespace tetwarp::test
