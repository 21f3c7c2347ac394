/// @file test_contact_problem.cpp
/// check_problem(): accepted problems, and the messages for rejected ones.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <tetwarp/contact_problem.hpp>

#include "host/contact/problem/matrix.hpp"
#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp {
namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Two bodies of 6 dofs, three contacts, all kinds of data.
ContactProblem global_problem() {
  std::mt19937 random(5);
  ContactProblem problem = samples::random_global(random, 2, 6, 0, 0.5);
  problem.adhesion = samples::adhesion_of(random, {1, 0, 2});
  for (std::size_t c = 0; c < 3; ++c) {
    problem.adhesion.gap[3 * c] = problem.adhesion.time_step * problem.velocity_offset[3 * c];
  }
  problem.impulse_guess.assign(9, 0.25);
  return problem;
}

ContactProblem local_problem() {
  std::mt19937 random(6);
  return samples::random_local(random, 2, 0.5, {1, 0});
}

struct BadProblem {
  const char* name;
  ContactProblem (*make)();
  std::function<void(ContactProblem&)> spoil;
  const char* field;
  const char* text;
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest calls it
void PrintTo(const BadProblem& bad, std::ostream* out) {
  *out << bad.name;
}

/// A body whose last two axes are equal up to rounding.
void make_singular(ContactProblem& problem) {
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(12, 12);
  system(4, 5) = system(5, 4) = 1 - 0x1p-53;
  problem.system = samples::sparse_of(system);
}

void set_tangents(ContactProblem& problem, double value) {
  Eigen::MatrixXd delassus = Eigen::MatrixXd::Identity(6, 6);
  delassus(4, 4) = delassus(5, 5) = value;
  problem.delassus = samples::sparse_of(delassus);
}

const BadProblem bad_problems[] = {
    {"NoForm", [] { return ContactProblem{}; }, [](ContactProblem&) {}, "system", ": empty"},
    {"BothForms", global_problem,
     [](ContactProblem& p) {
       p.free_velocity = {1, 2, 3};
     },
     "delassus", ": set together with"},
    {"NegativeFriction", global_problem, [](ContactProblem& p) { p.friction[2] = -0.25; },
     "friction", "[2]: -0.25 is negative; "},
    {"FrictionNotANumber", local_problem, [](ContactProblem& p) { p.friction[1] = nan; },
     "friction", "[1]: nan is not finite; "},
    {"InfiniteLoad", global_problem, [](ContactProblem& p) { p.load[7] = infinity; }, "load",
     "[7]: inf is not finite; "},
    {"ShortLoad", global_problem, [](ContactProblem& p) { p.load.pop_back(); }, "load",
     ": 11 entries, expected 12: one per dof"},
    {"ShortOffset", global_problem, [](ContactProblem& p) { p.velocity_offset.resize(3); },
     "velocity_offset", ": 3 entries, expected 9: 3 per contact"},
    {"OffsetNotANumber", global_problem, [](ContactProblem& p) { p.velocity_offset[4] = nan; },
     "velocity_offset", "[4]: nan is not finite; "},
    {"ShortFreeVelocity", local_problem, [](ContactProblem& p) { p.free_velocity.resize(5); },
     "free_velocity", ": 5 entries, expected 6"},
    {"FreeVelocityNotANumber", local_problem, [](ContactProblem& p) { p.free_velocity[0] = nan; },
     "free_velocity", "[0]: nan is not finite; "},
    {"FreeVelocityAlone", local_problem, [](ContactProblem& p) { p.delassus = {}; }, "delassus",
     ": 0 rows, expected 3 per contact, 6"},
    {"SystemNotSquare", global_problem, [](ContactProblem& p) { p.system.columns = 13; }, "system",
     ": 12 rows and 13 columns; it must be square"},
    {"NegativeRows", global_problem, [](ContactProblem& p) { p.system.rows = -1; }, "system",
     ": -1 rows and 12 columns"},
    {"FirstRowStart", global_problem, [](ContactProblem& p) { p.system.row_start[0] = 1; },
     "system.row_start", "[0]: 1, expected 0"},
    {"FallingRowStart", global_problem, [](ContactProblem& p) { p.system.row_start[1] = 40; },
     "system.row_start", "[2]: 12 is less than the previous entry"},
    {"LastRowStart", global_problem, [](ContactProblem& p) { p.jacobian.row_start.back() += 2; },
     "jacobian.row_start", "[9]: "},
    {"MissingRowStart", local_problem, [](ContactProblem& p) { p.delassus.row_start.pop_back(); },
     "delassus.row_start", ": 6 entries, expected 7: one per row and one more"},
    {"ColumnBeyondLast", global_problem, [](ContactProblem& p) { p.jacobian.column[3] = 12; },
     "jacobian.column", "[3]: 12, expected 0 to 11"},
    {"NegativeColumn", local_problem, [](ContactProblem& p) { p.delassus.column[5] = -1; },
     "delassus.column", "[5]: -1, expected 0 to 5"},
    {"ValuesAndColumns", local_problem, [](ContactProblem& p) { p.delassus.value.pop_back(); },
     "delassus.value", ": 35 entries, expected 36: one for each column index"},
    {"ValueNotANumber", global_problem, [](ContactProblem& p) { p.system.value[8] = nan; },
     "system.value", "[8]: nan is not finite; "},
    {"Asymmetric", global_problem, [](ContactProblem& p) { p.system.value[1] *= 1 + 1e-6; },
     "system", "(0, 1): "},
    {"OneTriangle", global_problem,
     [](ContactProblem& p) {
       Eigen::MatrixXd system = Eigen::MatrixXd::Identity(12, 12);
       system(7, 2) = 0.5;
       p.system = samples::sparse_of(system);
     },
     "system", "(7, 2): 0.5, but (2, 7) is 0; store both triangles"},
    {"SingularBlock", global_problem, make_singular, "system",
     ": the block of dofs 0 to 5 is not positive definite; "},
    {"NoMass", global_problem,
     [](ContactProblem& p) {
       Eigen::MatrixXd system = Eigen::MatrixXd::Identity(12, 12);
       system(9, 9) = 0;
       p.system = samples::sparse_of(system);
     },
     "system", ": the block of dofs 6 to 11 is not positive definite; "},
    {"FewerCoefficientsThanContacts", global_problem,
     [](ContactProblem& p) { p.friction.pop_back(); }, "adhesion.area",
     ": 3 entries, expected 2: one per contact"},
    {"JacobianColumns", global_problem, [](ContactProblem& p) { p.jacobian.columns = 15; },
     "jacobian", ": 9 rows and 15 columns, expected 3 per contact and one per dof, 9 and 12"},
    {"ImmovableContact", global_problem,
     [](ContactProblem& p) {
       for (std::int64_t e = p.jacobian.row_start[3]; e < p.jacobian.row_start[4]; ++e) {
         p.jacobian.value[static_cast<std::size_t>(e)] = 0;
       }
     },
     "jacobian", ": normal row 3 of contact 1 has diagonal 0; "},
    {"ImmovableTangents", local_problem, [](ContactProblem& p) { set_tangents(p, 0); }, "delassus",
     ": tangent rows 4 and 5 of contact 1 have diagonals 0 and 0; "},
    {"NegativeTangents", local_problem, [](ContactProblem& p) { set_tangents(p, -1); }, "delassus",
     ": tangent rows 4 and 5 of contact 1 have diagonals -1 and -1; "},
    {"DelassusSize", local_problem,
     [](ContactProblem& p) { p.delassus = samples::sparse_of(Eigen::MatrixXd::Identity(9, 9)); },
     "delassus", ": 9 rows, expected 3 per contact, 6"},
    {"NegativeArea", global_problem, [](ContactProblem& p) { p.adhesion.area[1] = -4; },
     "adhesion.area", "[1]: -4 is negative; "},
    {"NegativeStiffness", global_problem, [](ContactProblem& p) { p.adhesion.stiffness[0] = -1; },
     "adhesion.stiffness", "[0]: -1 is negative; "},
    {"NegativeTangentialStiffness", global_problem,
     [](ContactProblem& p) { p.adhesion.tangential_stiffness[2] = -2; },
     "adhesion.tangential_stiffness", "[2]: -2 is negative; "},
    {"IntensityOverOne", global_problem, [](ContactProblem& p) { p.adhesion.intensity[2] = 1.5; },
     "adhesion.intensity", "[2]: 1.5 is above 1; 0 is debonded, 1 fully bonded"},
    {"NegativeIntensity", global_problem, [](ContactProblem& p) { p.adhesion.intensity[0] = -0.5; },
     "adhesion.intensity", "[0]: -0.5 is negative; "},
    {"IntensityNotANumber", global_problem,
     [](ContactProblem& p) { p.adhesion.intensity[0] = nan; }, "adhesion.intensity",
     "[0]: nan is not finite; "},
    {"NegativeViscosity", global_problem,
     [](ContactProblem& p) {
       p.adhesion.viscosity = {0, 0, -1};
     },
     "adhesion.viscosity", "[2]: -1 is negative; "},
    {"EnergyCount", global_problem, [](ContactProblem& p) { p.adhesion.energy = {1}; },
     "adhesion.energy", ": 1 entries, expected 3: one per contact"},
    {"NoTimeStep", global_problem, [](ContactProblem& p) { p.adhesion.time_step = 0; },
     "adhesion.time_step", ": 0; a step of adhering contacts takes a finite time above 0 s"},
    {"TimeStepNotANumber", local_problem, [](ContactProblem& p) { p.adhesion.time_step = nan; },
     "adhesion.time_step", ": nan; "},
    {"GapCount", global_problem, [](ContactProblem& p) { p.adhesion.gap.resize(3); },
     "adhesion.gap", ": 3 entries, expected 9: 3 per contact"},
    {"Indefinite", local_problem,
     [](ContactProblem& p) {
       Eigen::MatrixXd delassus = Eigen::MatrixXd::Identity(6, 6);
       delassus(4, 1) = delassus(1, 4) = -1.5;
       p.delassus = samples::sparse_of(delassus);
     },
     "delassus", "(1, 4): -1.5 is more than the diagonals 1 and 1 allow"},
    {"BlockStartsLate", global_problem, [](ContactProblem& p) { p.block_start[0] = 1; },
     "block_start", "[0]: 1, expected 0"},
    {"EmptyBlock", global_problem,
     [](ContactProblem& p) {
       p.block_start = {0, 6, 6, 12};
     },
     "block_start", "[2]: 6 is not greater than the previous entry"},
    {"BlocksEndEarly", global_problem,
     [](ContactProblem& p) {
       p.block_start = {0, 6};
     },
     "block_start", "[1]: 6, expected the number of dofs, 12"},
    {"BlocksOfLocal", local_problem,
     [](ContactProblem& p) {
       p.block_start = {0, 6};
     },
     "block_start", ": set together with delassus"},
    {"GuessCount", local_problem,
     [](ContactProblem& p) {
       p.impulse_guess = {1, 2};
     },
     "impulse_guess", ": 2 entries, expected 6: 3 per contact, or none"},
    {"GuessNotANumber", global_problem, [](ContactProblem& p) { p.impulse_guess[8] = infinity; },
     "impulse_guess", "[8]: inf is not finite; "},
};

class ContactProblemCheck : public testing::TestWithParam<BadProblem> {};

TEST_P(ContactProblemCheck, NamesFieldAndIndexInOneLine) {
  ContactProblem problem = GetParam().make();
  GetParam().spoil(problem);

  try {
    check_problem(problem);
    FAIL() << "accepted";
  } catch (const ContactProblemError& error) {
    EXPECT_EQ(error.field(), GetParam().field) << error.what();
    EXPECT_EQ(std::string(error.what()).rfind(std::string(GetParam().field) + GetParam().text, 0),
              0u)
        << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(Bad, ContactProblemCheck, testing::ValuesIn(bad_problems), [](auto& info) {
  return std::string(info.param.name);
});

TEST(ContactProblem, GoodProblemsOfBothFormsPass) {
  EXPECT_NO_THROW(check_problem(global_problem()));
  EXPECT_NO_THROW(check_problem(local_problem()));
}

TEST(ContactProblem, AsymmetricDelassusPassesAsInRecordedFiles) {
  ContactProblem problem = local_problem();
  problem.delassus.value[1] += 1e-3;

  EXPECT_NO_THROW(check_problem(problem));
}

TEST(ContactProblem, ContactsThatResistNoSlidingNeedNoTangents) {
  ContactProblem problem = local_problem();
  set_tangents(problem, 0);
  problem.friction[1] = 0;

  EXPECT_NO_THROW(check_problem(problem));
}

TEST(ContactProblem, BodiesWithoutContactsPass) {
  ContactProblem problem;
  problem.system = samples::sparse_of(Eigen::MatrixXd::Identity(6, 6));
  problem.load.assign(6, 1.0);

  EXPECT_NO_THROW(check_problem(problem));
}

TEST(ContactProblem, RepeatedAndUnsortedEntriesAddUp) {
  ContactProblem problem = global_problem();
  const Eigen::MatrixXd before = make_eigen(problem.system);
  SparseMatrix& system = problem.system;
  std::reverse(system.column.begin(), system.column.begin() + 6);
  std::reverse(system.value.begin(), system.value.begin() + 6);
  system.value[2] -= 4;
  system.column.insert(system.column.begin(), system.column[2]);
  system.value.insert(system.value.begin(), 4.0);
  for (std::size_t row = 1; row < system.row_start.size(); ++row) ++system.row_start[row];

  EXPECT_NO_THROW(check_problem(problem));
  EXPECT_TRUE(make_eigen(make_sorted(system)).isApprox(before.sparseView(), 1e-15));
  EXPECT_TRUE(has_sorted_rows(make_sorted(system)));
  EXPECT_FALSE(has_sorted_rows(system));
}

TEST(ContactProblem, LargeBlocksAreCheckedToo) {
  ContactProblem problem = global_problem();
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(15, 15);
  system(14, 13) = system(13, 14) = 1;
  problem.system = samples::sparse_of(system);
  problem.jacobian.columns = 15;
  problem.load.resize(15, 0.0);
  problem.block_start = {0, 15};

  EXPECT_THROW(check_problem(problem), ContactProblemError);
  system(14, 14) = 2;
  problem.system = samples::sparse_of(system);
  EXPECT_NO_THROW(check_problem(problem));
}

TEST(ContactProblem, BlocksAreUncoupledRangesOrNodes) {
  ContactProblem problem;
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(22, 22);
  for (Eigen::Index d = 0; d < 5; ++d) system(d, d + 1) = system(d + 1, d) = 0.25;
  for (Eigen::Index d = 9; d < 21; ++d) system(d, d + 1) = system(d + 1, d) = 0.25;
  problem.system = samples::sparse_of(system);

  EXPECT_EQ(blocks_of(problem), (std::vector<std::int32_t>{0, 6, 7, 8, 9, 12, 15, 18, 21, 22}));
}
}  // namespace
}  // namespace tetwarp
