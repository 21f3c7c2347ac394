/// @file test_io_fclib_solution.cpp
/// The parts of an FCLIB file besides the problem: texts, guesses, solutions.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/contact/contact_files.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
class FclibSolution : public testing::Test {
 protected:
  ScratchFolder folder;
  std::string file = folder / "problem.hdf5";
};

TEST_F(FclibSolution, TellsWhatStandsAroundTheProblem) {
  write_contact_problem(file, adhesive_problem(), "two points", "one on the other");

  const ContactFileHeader header = read_contact_header(file);

  EXPECT_EQ(header.title, "two points");
  EXPECT_EQ(header.description, "one on the other");
  EXPECT_EQ(header.guesses, 1);
  EXPECT_FALSE(header.has_solution);
  EXPECT_FALSE(header.status || header.residual);
  EXPECT_EQ(kind_of(file), FileKind::contact_problem);
}

/// A solution for adhesive_problem() with made-up numbers.
ContactSolution some_solution() {
  ContactSolution solution;
  solution.impulse = {1, 2, 3, 4, 5, 6};
  solution.velocity = {0, 0.5, 0, 0, 0.25, 0};
  solution.body_velocity = {6, 5, 4, 3, 2, 1};
  solution.report.method = "anderson";
  solution.report.status = ContactStatus::converged;
  solution.report.residual.eta = 0.125;
  solution.report.residual.fclib = 0.25;
  solution.report.residual_history = {1, 0.5, 0.125};
  return solution;
}

TEST_F(FclibSolution, WritesASolutionBesideItsProblem) {
  write_contact_problem(file, adhesive_problem(), "two points");
  const ContactSolution solution = some_solution();
  const std::string solved = folder / "solved.hdf5";

  write_contact_solution(solved, file, solution);

  EXPECT_EQ(contents(read_contact_problem(solved)), contents(read_contact_problem(file)));
  EXPECT_EQ(numbers_of(solved, "solution/r"), solution.impulse);
  EXPECT_EQ(numbers_of(solved, "solution/u"), solution.velocity);
  EXPECT_EQ(numbers_of(solved, "solution/v"), solution.body_velocity);
  EXPECT_EQ(numbers_of(solved, "solution/residual_history"), solution.report.residual_history);
  EXPECT_EQ(attribute_of(solved, "solution", "converged"), 1);
  EXPECT_EQ(attribute_of(solved, "solution", "fclib_error"), 0.25);
  EXPECT_FALSE(holds(solved, "adhesion_next"));
  const ContactFileHeader header = read_contact_header(solved);
  EXPECT_EQ(header.title, "two points");
  EXPECT_EQ(header.guesses, 1);
  EXPECT_TRUE(header.has_solution);
  EXPECT_EQ(header.status, "converged");
  EXPECT_EQ(header.residual, 0.125);
  EXPECT_EQ(folder.entry_count(), 2);
}

TEST_F(FclibSolution, MarksASolutionThatDidNotConverge) {
  write_contact_problem(file, adhesive_problem());
  ContactSolution solution = some_solution();
  solution.report.status = ContactStatus::infeasible;

  write_contact_solution(folder / "solved.hdf5", file, solution);

  EXPECT_EQ(attribute_of(folder / "solved.hdf5", "solution", "converged"), 0);
  EXPECT_EQ(read_contact_header(folder / "solved.hdf5").status, "infeasible");
}

TEST_F(FclibSolution, ReplacesAnOlderSolutionAndKeepsEverythingElse) {
  write_contact_problem(file, adhesive_problem());
  Hdf5Editor(file)
      .group("solution")
      .dataset<double>("solution/r", {2}, {8, 9})
      .dataset<double>("solution/l", {1}, {7})
      .group("adhesion_next")
      .dataset<double>("adhesion_next/energy", {1}, {7})
      .group("certified")
      .dataset<double>("certified/v", {2}, {0.5, 0.25});
  const std::string solved = folder / "solved.hdf5";
  const AdhesionStep next{{0.75, 0.5}, {1, 2, 3, 4, 5, 6}, {0, 1}};

  write_contact_solution(solved, file, some_solution(), &next);

  EXPECT_EQ(numbers_of(solved, "solution/r"), some_solution().impulse);
  EXPECT_FALSE(holds(solved, "solution/l"));
  EXPECT_EQ(numbers_of(solved, "certified/v"), (std::vector<double>{0.5, 0.25}));
  EXPECT_EQ(numbers_of(solved, "adhesion_next/intensity"), next.intensity);
  EXPECT_EQ(numbers_of(solved, "adhesion_next/gap"), next.gap);
  EXPECT_FALSE(holds(solved, "adhesion_next/energy"));
}

TEST_F(FclibSolution, RefusesTheSolutionOfAnotherProblem) {
  write_contact_problem(file, adhesive_problem());
  ContactSolution solution = some_solution();
  solution.body_velocity.pop_back();

  const std::string error =
      io_error([&] { write_contact_solution(folder / "solved.hdf5", file, solution); });

  EXPECT_NE(error.find("/fclib_global/vectors/f"), std::string::npos) << error;
  EXPECT_NE(error.find("the solution is of another problem"), std::string::npos) << error;
  EXPECT_EQ(folder.entry_count(), 1);
}
}  // namespace
}  // namespace tetwarp::test
