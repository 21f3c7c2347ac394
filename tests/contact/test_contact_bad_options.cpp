/// @file test_contact_bad_options.cpp
/// Options out of range throw before anything is solved; the ends of the ranges are accepted.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/error.hpp>

#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct OptionsCase {
  const char* name;
  ContactOptions options;
  const char* named;  ///< how the message starts; good options: empty
};

class ContactBadOptions : public ::testing::TestWithParam<OptionsCase> {};

const std::vector<OptionsCase> cases = {
    {"Defaults", {}, ""},
    {"ToleranceZero", {.tolerance = 0}, "tolerance"},
    {"ToleranceNegative", {.tolerance = -1e-6}, "tolerance"},
    {"ToleranceNan", {.tolerance = nan}, "tolerance"},
    {"ToleranceInfinite", {.tolerance = infinity}, "tolerance"},
    {"ToleranceTiny", {.tolerance = 1e-300}, ""},
    {"SweepsZero", {.max_sweeps = 0}, "max_sweeps"},
    {"SweepsNegative", {.max_sweeps = -1}, "max_sweeps"},
    {"SweepsOne", {.max_sweeps = 1}, ""},
    {"RelaxationZero", {.expert = {.relaxation = 0}}, "relaxation"},
    {"RelaxationNegative", {.expert = {.relaxation = -0.5}}, "relaxation"},
    {"RelaxationTwo", {.expert = {.relaxation = 2}}, "relaxation"},
    {"RelaxationNan", {.expert = {.relaxation = nan}}, "relaxation"},
    {"RelaxationBelowTwo", {.expert = {.relaxation = 1.99}}, ""},
    {"InnerSweepsZero", {.expert = {.inner_sweeps = 0}}, "inner_sweeps"},
    {"InnerSweepsNegative", {.expert = {.inner_sweeps = -5}}, "inner_sweeps"},
    {"InnerSweepsOne", {.expert = {.inner_sweeps = 1}}, ""},
    {"RecoverySpeedNegative", {.recovery_speed = -1e-9}, "recovery_speed"},
    {"RecoverySpeedNan", {.recovery_speed = nan}, "recovery_speed"},
    {"RecoverySpeedZero", {.recovery_speed = 0}, ""},
    {"SecondsZero", {.max_seconds = 0}, "max_seconds"},
    {"SecondsNan", {.max_seconds = nan}, "max_seconds"},
    {"NewtonNegative", {.max_newton = -1}, "max_newton"},
    {"NewtonZero", {.max_newton = 0}, ""},
    {"MemoryNegative", {.max_memory = -1}, "max_memory"},
    {"ThreadsNegative", {.threads = -1}, "threads"},
    {"ThreadsBeyondTheLimit", {.threads = 100000}, "threads"},
    {"ThreadsOne", {.threads = 1}, ""}};
INSTANTIATE_TEST_SUITE_P(Of, ContactBadOptions, ::testing::ValuesIn(cases), [](const auto& info) {
  return std::string(info.param.name);
});

/// A contact at rest.
ContactProblem quiet_contact() {
  ContactProblem problem;
  problem.delassus = {3, 3, {0, 1, 2, 3}, {0, 1, 2}, {1, 1, 1}};
  problem.free_velocity = {0, 0, 0};
  problem.friction = {0.5};
  return problem;
}

TEST_P(ContactBadOptions, AreNamedInOneLine) {
  const OptionsCase& given = GetParam();
  const std::string made = message_of([&] { ContactSolver{given.options}; });
  const std::string solved = message_of([&] { solve_contacts(quiet_contact(), given.options); });

  EXPECT_EQ(made.empty(), std::string(given.named).empty()) << made;
  EXPECT_EQ(made.find(given.named), 0U) << made;
  EXPECT_EQ(made.find('\n'), std::string::npos);
  EXPECT_EQ(solved, made);
}

/// Back end reference throws the same.
TEST_P(ContactBadOptions, AreNamedByTheReferenceToo) {
  ContactOptions options = GetParam().options;
  const std::string made = message_of([&] { ContactSolver{options}; });
  options.backend = Backend::reference;

  EXPECT_EQ(message_of([&] { solve_contacts(quiet_contact(), options); }), made);
}

TEST(ContactBadDevice, IsACudaError) {
  EXPECT_THROW(ContactSolver(ContactOptions{.backend = Backend::cuda, .device = 4096}), CudaError);
}
}  // namespace
}  // namespace tetwarp::test
