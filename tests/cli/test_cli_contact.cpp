/// @file test_cli_contact.cpp
/// `tetwarp contact`: files, text and exit codes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/support/contact/contact_command.hpp"
#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp::test {
namespace {
void expect_near(const std::vector<double>& actual, const std::vector<double>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 1e-5) << i;
}

/// In closed form: the impulse stops the fall, and friction takes mu = 0.3 of the sliding speed.
TEST_F(ContactCommand, StopsAFallAndBrakesASlide) {
  store(sliding_point());

  const CommandResult result = solve();

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("1 contact, converged"), std::string::npos) << result.out;
  const double speed = std::hypot(0.5, 0.25);
  expect_near(solved("solution/r"), {1, -0.3 * 0.5 / speed, -0.3 * 0.25 / speed});
  expect_near(solved("solution/u"), {0, (speed - 0.3) * 0.5 / speed, (speed - 0.3) * 0.25 / speed});
  EXPECT_EQ(solution_attribute("converged"), 1);
  EXPECT_EQ(folder.names(), (Names{"problem.hdf5", "solved.hdf5"}));
}

/// The pyramid bounds each tangent separately, so that the slower one stops.
TEST_F(ContactCommand, BrakesEachTangentByThePyramid) {
  store(sliding_point());

  EXPECT_EQ(solve({"--law", "pyramid"}).exit_code, 0);

  expect_near(solved("solution/r"), {1, -0.3, -0.25});
  expect_near(solved("solution/u"), {0, 0.2, 0});
}

/// One contact pulled with 1 N s: lambda = kappa d / (1 + kappa B), kappa = dt^2 area C.
ContactProblem pulled_point() {
  ContactProblem problem;
  problem.system = sparse({{2, 0, 0}, {0, 2, 0}, {0, 0, 2}});
  problem.jacobian = sparse({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  problem.load = {1, 0, 0};
  problem.velocity_offset = {0, 0, 0};
  problem.friction = {0.5};
  problem.adhesion.time_step = 0.125;
  problem.adhesion.area = {0.5};
  problem.adhesion.stiffness = {1024};
  problem.adhesion.intensity = {0.5};
  return problem;
}

TEST_F(ContactCommand, HoldsABodyByItsAdhesion) {
  store(pulled_point());

  EXPECT_EQ(solve().exit_code, 0);

  const double kappa = 0.125 * 0.125 * 0.5 * 1024 * 0.25;
  const double impulse = -kappa * 0.5 / (1 + kappa * 0.5);
  expect_near(solved("solution/r"), {impulse, 0, 0});
  expect_near(solved("solution/v"), {(1 + impulse) / 2, 0, 0});
  EXPECT_FALSE(holds(folder / "solved.hdf5", "adhesion_next"));
}

TEST_F(ContactCommand, WritesTheAdhesionOfTheNextStepWithEvolve) {
  store(pulled_point());

  EXPECT_EQ(solve({"--evolve"}).exit_code, 0);

  // This adhesion neither bonds nor debonds; the gap of its anchors grew by dt u.
  expect_near(solved("adhesion_next/intensity"), {0.5});
  const std::vector<double> velocity = solved("solution/u");
  expect_near(solved("adhesion_next/gap"), {0.125 * velocity[0], 0, 0});
}

TEST_F(ContactCommand, WritesTheBestIterateAndExitsWithThreeWhenItDoesNotConverge) {
  store(column_of_points(30));

  const CommandResult result =
      solve({"--solver", "gs", "--max-sweeps", "2", "--tolerance", "1e-12"});

  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("problem.hdf5: not converged: residual "), std::string::npos)
      << result.err;
  EXPECT_EQ(solution_attribute("converged"), 0);
  EXPECT_EQ(solved("solution/r").size(), 90u);
  EXPECT_EQ(read_contact_header(folder / "solved.hdf5").status, "not converged");
}

TEST_F(ContactCommand, MarksAndRefusesWhatNoVelocitySatisfies) {
  store(squeezed_point());

  const CommandResult result = solve();

  EXPECT_EQ(result.exit_code, 4);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("infeasible"), std::string::npos) << result.err;
  EXPECT_EQ(solution_attribute("converged"), 0);
  EXPECT_EQ(read_contact_header(folder / "solved.hdf5").status, "infeasible");
  for (const double r : solved("solution/r")) EXPECT_TRUE(std::isfinite(r));
}

TEST_F(ContactCommand, StopsAtItsLimits) {
  std::mt19937 random(5);
  store(samples::random_global(random, 20, 6, 0.2, 0.4));

  for (const std::vector<std::string>& limit : {std::vector<std::string>{"--max-seconds", "1e-9"},
                                                {"--max-newton", "0"},
                                                {"--memory", "1k"}}) {
    std::vector<std::string> arguments = {"--max-sweeps", "2", "--tolerance", "1e-15"};
    arguments.insert(arguments.end(), limit.begin(), limit.end());
    const CommandResult result = solve(arguments);

    EXPECT_EQ(result.exit_code, 3);
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find("max_"), std::string::npos) << result.err;
  }
}

TEST_F(ContactCommand, SolvesJointsRollingFrictionAndEllipses) {
  store(jointed_problem());

  const CommandResult result =
      solve({"--modes", "--energy", "--report", "report.json", "--tolerance", "1e-9"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  const ContactProblem problem = read_contact_problem(folder / "problem.hdf5");
  const ContactSolution expected = solve_contacts(problem, {.tolerance = 1e-9});
  expect_near(solved("solution/v"), expected.body_velocity);
  expect_near(solved("solution/l"), expected.bilateral_impulse);
  expect_near(solved("solution/m"), expected.rolling_impulse);
  EXPECT_EQ(solved("solution/contact_mode").size(), 2U);
  EXPECT_EQ(solved("solution/contact_residual").size(), 2U);
  const Json json = report();
  EXPECT_EQ(json["bilateral_rows"], 3);
  EXPECT_EQ(json["rolling_contacts"], 1);
  const Json info = Json::parse(run_command(folder, {"info", "problem.hdf5", "--json"}).out);
  EXPECT_EQ(info["bilateral_rows"], 3);
  EXPECT_EQ(info["rolling_contacts"], 1);
  EXPECT_LE(std::abs(json["energy"]["error"].get<double>()), 1e-12);
  EXPECT_GE(json["energy"]["friction_loss"].get<double>(), -1e-9);
}

TEST_F(ContactCommand, ReportsInJson) {
  store(global_problem());

  EXPECT_EQ(solve({"--report", "report.json", "--backend", "cpu"}).exit_code, 0);

  const Json json = report();
  EXPECT_EQ(json["backend"], "cpu");
  EXPECT_EQ(json["converged"], true);
  EXPECT_EQ(json["contacts"], 2);
  EXPECT_LE(json["residual"], 1e-6);
  EXPECT_FALSE(json["residual_history"].empty());
  const Json& timings = json["timings"];
  EXPECT_GE(timings["total"], timings["read"].get<double>() + timings["write"].get<double>());
}

TEST_F(ContactCommand, StartsFromASolutionWithWarmStart) {
  store(column_of_points(30));
  ASSERT_EQ(solve({"--tolerance", "1e-8", "--report", "report.json"}).exit_code, 0);
  const std::int64_t cold = report()["sweeps"];
  fs::rename(folder / "solved.hdf5", folder / "problem.hdf5");

  EXPECT_EQ(solve({"--warm-start", "--tolerance", "1e-6", "--report", "report.json"}).exit_code, 0);

  EXPECT_LT(report()["sweeps"], cold);
}

TEST_F(ContactCommand, SolvesToFclibsMeasure) {
  store(column_of_points(10));

  EXPECT_EQ(solve({"--measure", "fclib", "--tolerance", "1e-8"}).exit_code, 0);

  EXPECT_LE(solution_attribute("fclib_error"), 1e-8);
}

TEST_F(ContactCommand, WritesTheSameBytesForAnyNumberOfThreads) {
  store(adhesive_problem());

  ASSERT_EQ(solve({"--threads", "1"}).exit_code, 0);
  const std::string one = text_of(folder / "solved.hdf5");
  ASSERT_EQ(solve({"--threads", "2"}).exit_code, 0);

  EXPECT_EQ(text_of(folder / "solved.hdf5"), one);
}

TEST_F(ContactCommand, FindsTheSameVelocitiesByEveryMethod) {
  store(adhesive_problem());
  ASSERT_EQ(solve({"--backend", "reference", "--tolerance", "1e-8"}).exit_code, 0);
  const std::vector<double> expected = solved("solution/v");

  for (const Names& words : std::vector<Names>{{"--solver", "gs"},
                                               {"--solver", "nncg"},
                                               {"--solver", "anderson"},
                                               {"--solver", "newton"},
                                               {"--precision", "single", "--tolerance", "1e-5"},
                                               {"--no-skip", "all"},
                                               {"--coupling", "condensed"},
                                               {"--coupling", "iterated", "--inner", "2"},
                                               {"--relaxation", "1"}}) {
    Names all = {"--tolerance", "1e-8"};
    all.insert(all.end(), words.begin(), words.end());
    if (words.front() == "--precision") all.erase(all.begin(), all.begin() + 2);

    const CommandResult result = solve(all);

    EXPECT_EQ(result.exit_code, 0) << words.back() << ": " << result.err;
    expect_near(solved("solution/v"), expected);
  }
}

TEST_F(ContactCommand, PrintsNothingWithQuiet) {
  store(sliding_point());

  const CommandResult result = solve({"--quiet"});

  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out + result.err, "");
}

/// Coulomb's law of random problems with friction far above 1: what is said to be solved keeps it
/// to 1e-5 of the largest impulse and velocity; else the exit code is 3 and the message states the
/// residual.
TEST_F(ContactCommand, KeepsTheLawOfLargeFrictionOrSaysThatItDoesNot) {
  std::mt19937 random(46);
  std::normal_distribution<double> normal;
  for (const double friction : {1e4, 1e6, 1e8}) {
    for (int run = 0; run < 4; ++run) {
      const std::size_t contacts = 2 + random() % 8, rows = 3 * contacts;
      std::vector<std::vector<double>> jacobian(rows, std::vector<double>(12));
      for (auto& row : jacobian) {
        for (double& entry : row) entry = normal(random);
      }
      ContactProblem problem;
      std::vector<std::vector<double>> delassus(rows, std::vector<double>(rows));
      for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t j = 0; j < rows; ++j) {
          for (std::size_t k = 0; k < 12; ++k) delassus[i][j] += jacobian[i][k] * jacobian[j][k];
        }
        double free = 0;
        for (std::size_t k = 0; k < 12; ++k) free += jacobian[i][k] * (k % 3 == 0 ? -1.0 : 0.5);
        problem.free_velocity.push_back(free);
      }
      problem.delassus = sparse(delassus);
      problem.friction.assign(contacts, friction);
      store(problem);

      const CommandResult result = solve();

      if (result.exit_code == 3) {
        EXPECT_NE(result.out.find("residual"), std::string::npos) << result.out;
        continue;
      }
      ASSERT_EQ(result.exit_code, 0) << result.err;
      const std::vector<double> r = solved("solution/r");
      std::vector<double> u = problem.free_velocity;
      for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t j = 0; j < rows; ++j) u[i] += delassus[i][j] * r[j];
      }
      const auto size = [](double a, double b) { return std::abs(a) < std::abs(b); };
      const double r_scale = std::abs(*std::max_element(r.begin(), r.end(), size)) + 1e-300;
      const double u_scale = std::abs(
          *std::max_element(problem.free_velocity.begin(), problem.free_velocity.end(), size));
      for (std::size_t c = 0; c < rows; c += 3) {
        const double push = r[c] / r_scale, part = u[c] / u_scale;
        const double drag = std::hypot(r[c + 1], r[c + 2]) / r_scale;
        const double slip = std::hypot(u[c + 1], u[c + 2]) / u_scale;
        EXPECT_LE(std::abs(std::min(push, part)), 1e-5) << friction;
        EXPECT_LE(std::max(drag - friction * push, 0.0), 1e-5) << friction;
        EXPECT_LE(std::min(slip, std::max(friction * push - drag, 0.0)), 1e-5) << friction;
      }
    }
  }
}

TEST_F(ContactCommand, IsUnderstoodByInfo) {
  write_contact_problem(folder / "problem.hdf5", adhesive_problem(), "two points");
  ASSERT_EQ(solve().exit_code, 0);

  const Json before = Json::parse(run_command(folder, {"info", "problem.hdf5", "--json"}).out);
  const Json after = Json::parse(run_command(folder, {"info", "solved.hdf5", "--json"}).out);

  EXPECT_EQ(before["kind"], "contact problem");
  EXPECT_EQ(before["title"], "two points");
  EXPECT_EQ(before["form"], "global");
  EXPECT_EQ(before["contacts"], 2);
  EXPECT_EQ(before["dofs"], 6);
  EXPECT_EQ(before["entries"], (Json{{"M", 6}, {"H", 9}}));
  EXPECT_EQ(before["blocks"], 2);
  EXPECT_EQ(before["friction"], (Json{0.25, 0.5}));
  EXPECT_EQ(before["adhesion"]["bonded"], 2);
  EXPECT_EQ(before["guesses"], 1);
  EXPECT_EQ(before["solution"], "none");
  EXPECT_EQ(after["solution"], "converged");
  EXPECT_LE(after["residual"], 1e-6);
}
}  // namespace
}  // namespace tetwarp::test
