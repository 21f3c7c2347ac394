/// @file test_contact_threads.cpp
/// Solves large enough to use threads: bits do not depend on their number.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include <tetwarp/contact.hpp>

#include "host/contact/structure/structure.hpp"
#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::test {
namespace {
class ContactThreads : public ::testing::TestWithParam<ContactMethod> {
 protected:
  static void expect_same_bits_for_any_number(const ContactProblem& problem,
                                              double tolerance,
                                              std::int64_t sweeps) {
    ContactOptions options{
        .method = GetParam(), .tolerance = tolerance, .max_sweeps = sweeps, .threads = 1};
    const ContactSolution one = solve_contacts(problem, options);
    for (options.threads = 2; options.threads <= 3; ++options.threads) {
      expect_same_bits(solve_contacts(problem, options), one, std::to_string(options.threads));
    }
  }
};
INSTANTIATE_TEST_SUITE_P(By, ContactThreads, ::testing::ValuesIn(methods), [](const auto& info) {
  return report_name_of(info.param);
});

/// One island, its colors wide enough to be shared among threads.
TEST_P(ContactThreads, ShareTheContactsOfALargeIsland) {
  const ContactProblem problem =
      scenes::random_local({.seed = 11, .contacts = 18000, .neighbors = 2});
  const ContactStructure structure = make_structure(problem, {});
  const ContactIsland& island = structure.islands[0];
  const std::int64_t* colors = structure.color_start.data() + island.color_begin;
  ASSERT_GE(island.contact_count(), 16384);
  ASSERT_GE(colors[1] - colors[0], 4000);

  expect_same_bits_for_any_number(problem, 1e-2, 30);
}

TEST_P(ContactThreads, TakeIslandsSideBySide) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 12, .edge = 12, .kept = 0.1});
  ASSERT_GE(make_structure(problem, {}).contact_islands, 200);

  expect_same_bits_for_any_number(problem, 1e-6, 2000);
}
}  // namespace
}  // namespace tetwarp::test
