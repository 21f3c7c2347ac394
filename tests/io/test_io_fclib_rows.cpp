/// @file test_io_fclib_rows.cpp
/// Friction ellipses, bilateral rows and rolling friction in FCLIB files.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/contact/contact_files.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
class FclibRows : public testing::Test {
 protected:
  /// The error of reading jointed_problem() after a change of its file.
  template <class Damage>
  std::string error_after(const Damage& damage) {
    write_contact_problem(file, jointed_problem());
    damage(Hdf5Editor(file));
    return io_error([&] { read_contact_problem(file, ContactStart::stored); });
  }

  ScratchFolder folder;
  std::string file = folder / "problem.hdf5";
};

TEST_F(FclibRows, AreKept) {
  write_contact_problem(file, jointed_problem());

  EXPECT_EQ(contents(read_contact_problem(file, ContactStart::stored)),
            contents(jointed_problem()));
}

/// As FCLIB defines them: G is transposed, and G^T v + b = 0.
TEST_F(FclibRows, BilateralRowsAreEqualityConstraintsOfFclib) {
  write_contact_problem(file, jointed_problem());

  EXPECT_EQ(numbers_of(file, "fclib_global/G/m"), std::vector<double>{6});
  EXPECT_EQ(numbers_of(file, "fclib_global/G/n"), std::vector<double>{3});
  EXPECT_EQ(numbers_of(file, "fclib_global/vectors/b"), (std::vector<double>{0, -0.5, 0.25}));
}

/// Other programs store neither groups nor compliances.
TEST_F(FclibRows, FilesOfOtherProgramsHaveSingleHardRows) {
  write_contact_problem(file, jointed_problem());
  Hdf5Editor(file).remove("bilateral").remove("rolling").remove("friction");

  const ContactProblem problem = read_contact_problem(file);

  EXPECT_EQ(problem.bilateral.row_count(), 3);
  EXPECT_TRUE(problem.bilateral.compliance.empty());
  EXPECT_TRUE(problem.bilateral.group_start.empty());
  EXPECT_TRUE(problem.rolling.empty());
  EXPECT_TRUE(problem.second_friction.empty());
}

TEST_F(FclibRows, ImpulsesAndModesAreWrittenWithTheSolution) {
  ContactProblem problem = jointed_problem();
  write_contact_problem(file, problem);
  ContactSolution solution;
  solution.impulse = {1, 2, 3, 4, 5, 6};
  solution.velocity = {0, 0.5, 0, 0, 0.25, 0};
  solution.body_velocity = {6, 5, 4, 3, 2, 1};
  solution.bilateral_impulse = {7, 8, 9};
  solution.rolling_impulse = {10, 11, 12};
  const ContactModes modes = {{ContactMode::open, ContactMode::slide}, {0.25, 0.5}, {}, {}};
  const std::string solved = folder / "solved.hdf5";

  write_contact_solution(solved, file, solution, nullptr, &modes);

  EXPECT_EQ(numbers_of(solved, "solution/contact_mode"), (std::vector<double>{0, 2}));
  EXPECT_EQ(numbers_of(solved, "solution/contact_residual"), modes.residual);
  const ContactProblem again = read_contact_problem(solved, ContactStart::stored);
  EXPECT_EQ(again.impulse_guess, solution.impulse);
  EXPECT_EQ(again.bilateral.impulse_guess, solution.bilateral_impulse);
  EXPECT_EQ(again.rolling.impulse_guess, solution.rolling_impulse);
}

TEST_F(FclibRows, ErrorsNameTheDataset) {
  const auto expect = [](const std::string& error, const char* dataset, const char* text) {
    EXPECT_NE(error.find(dataset), std::string::npos) << error;
    EXPECT_NE(error.find(text), std::string::npos) << error;
  };
  expect(error_after([](Hdf5Editor e) { e.remove("fclib_global/vectors/b"); }),
         "/fclib_global/vectors/b", "missing");
  expect(error_after([](Hdf5Editor e) {
           e.dataset<double>("bilateral/compliance", {3}, {0, -1, 0});
         }),
         "/bilateral/compliance", "-1 is negative");
  expect(error_after([](Hdf5Editor e) { e.dataset<double>("bilateral/compliance", {1}, {0}); }),
         "/bilateral/compliance", "one per column of G");
  expect(error_after([](Hdf5Editor e) {
           e.dataset<int>("bilateral/group_ptr", {2}, {0, 2});
         }),
         "/bilateral/group_ptr", "expected the number of rows, 3");
  expect(error_after([](Hdf5Editor e) { e.dataset<int>("rolling/contact", {1}, {7}); }),
         "/rolling/contact", "7, expected 0 to 1");
  expect(error_after([](Hdf5Editor e) { e.dataset<double>("rolling/torsion", {1}, {-2}); }),
         "/rolling/torsion", "-2 is negative");
  expect(error_after([](Hdf5Editor e) {
           e.dataset<double>("friction/second", {2}, {0, -3});
         }),
         "/friction/second", "-3 is negative");
  expect(error_after([](Hdf5Editor e) { e.dataset<double>("guesses/1/l", {1}, {0}); }),
         "/guesses/1/l", "one per column of G");
}

TEST_F(FclibRows, TakeTheGlobalForm) {
  write_contact_problem(file, local_problem());
  Hdf5Editor(file).group("rolling").dataset<int>("rolling/contact", {1}, {0});

  const std::string error = io_error([&] { read_contact_problem(file); });

  EXPECT_NE(error.find("/rolling"), std::string::npos) << error;
  EXPECT_NE(error.find("take the global form"), std::string::npos) << error;
}
}  // namespace
}  // namespace tetwarp::test
