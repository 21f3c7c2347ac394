/// @file test_contact_simt.cpp
/// Islands solved by one block each, run by emulation in several thread orders on the host's own
/// arrays: sweeps have the bits of the host, accelerated methods its results up to rounding.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/emulated/island_solves.hpp"
#include "tests/support/contact/contact_methods.hpp"

namespace tetwarp::test {
namespace {
/// 11 sweeps of all islands: in shared memory under every schedule, in place under one.
template <class T>
void expect_equal_bits(const ContactProblem& problem,
                       ContactSwitches switches = {},
                       bool separates_islands = false,
                       bool freezes = false) {
  const SweepScene scene(problem, separates_islands);
  const MethodPlan plan = {ContactMethod::gauss_seidel, 1e-3, freezes ? 60 : 11};
  IslandSolves<T> solves(scene, plan, {ContactMeasure::eta, 0, 0});
  solves.switches = switches;
  solves.freezes = freezes;
  const std::vector<T> host = solves.by_host();
  const auto expect_host_bits = [&](Place place) {
    EXPECT_TRUE(has_bits_of(solves.by_blocks(place), host));
    for (std::size_t i = 0; i < solves.results.size(); ++i) {
      EXPECT_EQ(solves.results[i].end.sweeps, solves.host_ends[i].sweeps);
      // Same terms, another tree.
      const ContactSums& sums = solves.sums[i].sums;
      EXPECT_NEAR(sums.eta, solves.host_sums[i].eta, 1e-12 * solves.host_sums[i].eta);
      EXPECT_EQ(sums.largest, solves.host_sums[i].largest);
    }
  };
  simt::for_each_schedule([&](const simt::Schedule&) { expect_host_bits(Place::shared); });
  for (const Place place : places) expect_host_bits(place);
}

constexpr std::int64_t sizes[] = {1, 31, 32, 33, 100};

ContactProblem packed_spheres(std::int64_t contacts, const scenes::Glue& glue = {}) {
  return first_contacts(scenes::sphere_packing({.seed = 3, .edge = 4, .glue = glue}), contacts);
}

TEST(ContactIslandSimt, LocalProblemsHaveTheBitsOfTheHost) {
  for (const std::int64_t contacts : sizes) {
    expect_equal_bits<double>(scenes::random_local({.seed = 5, .contacts = contacts}));
    expect_equal_bits<float>(scenes::random_local({.seed = 6, .contacts = contacts}));
  }
}

/// Rows of more blocks than a warp has lanes.
ContactProblem long_rows(std::int64_t contacts) {
  const ContactProblem problem = scenes::random_local(
      {.seed = 9, .contacts = contacts, .neighbors = 80, .asymmetry = 1e-3, .glue = {1e6, 0.7}});
  const SweepScene scene(problem, false);
  EXPECT_TRUE(has_long_rows(scene.system.numbers(scene.structure.indices()).delassus));
  return problem;
}

TEST(ContactIslandSimt, LongRowsHaveTheBitsOfTheHost) {
  expect_equal_bits<double>(long_rows(36));
}

TEST(LongContactIslandSimt, LongRowsHaveTheBitsOfTheHost) {
  for (const ContactSwitches switches : {ContactSwitches{}, ContactSwitches{true, true}}) {
    expect_equal_bits<double>(long_rows(50), switches);
    expect_equal_bits<float>(long_rows(50), switches);
    expect_equal_bits<double>(long_rows(50), switches, false, true);
  }
}

TEST(ContactIslandSimt, RigidBodiesHaveTheBitsOfTheHost) {
  for (const std::int64_t contacts : sizes) {
    expect_equal_bits<double>(packed_spheres(contacts));
    expect_equal_bits<float>(packed_spheres(contacts));
  }
  expect_equal_bits<double>(first_contacts(scenes::box_stack({.boxes = 25}), 33));
}

/// More contacts of one color than a block has threads.
TEST(ContactIslandSimt, WideColorsHaveTheBitsOfTheHost) {
  const ContactProblem problem = scenes::random_local({.seed = 7, .contacts = 700});
  const ContactStructure structure = make_structure(problem, {.converged_islands = false});
  EXPECT_GT(structure.color_start[1] - structure.color_start[0], island_threads);

  expect_equal_bits<double>(problem);
}

TEST(ContactIslandSimt, EveryLawAndRuleHasTheBitsOfTheHost) {
  const scenes::Glue glue = {1e6, 0.7};
  for (const ContactSwitches switches :
       {ContactSwitches{true, false}, ContactSwitches{false, true}, ContactSwitches{true, true}}) {
    expect_equal_bits<double>(
        scenes::random_local({.seed = 8, .contacts = 33, .asymmetry = 1e-3, .glue = glue}),
        switches);
    expect_equal_bits<double>(packed_spheres(33, glue), switches);
  }
}

TEST(ContactIslandSimt, IslandsSideBySideHaveTheBitsOfTheHost) {
  const ContactProblem spheres = scenes::sphere_packing({.seed = 9, .edge = 5, .kept = 0.2});
  EXPECT_GT(make_structure(spheres, {}).contact_islands, 5);

  expect_equal_bits<double>(spheres, {}, true);
  expect_equal_bits<float>(spheres, {}, true);
}

TEST(ContactIslandSimt, FrozenContactsAreTheSameOnes) {
  expect_equal_bits<double>(packed_spheres(100), {}, false, true);
}

/// Every method, to a tolerance: equal results up to the order of sums.
TEST(ContactIslandSimt, EveryMethodEndsWhereItDoesOnTheHost) {
  const ContactProblem problems[] = {
      scenes::random_local({.seed = 10, .contacts = 60, .neighbors = 2}), packed_spheres(100)};
  for (const ContactProblem& problem : problems) {
    const SweepScene scene(problem, true);
    for (const ContactMethod method : methods) {
      IslandSolves<double> solves(scene, {method, 0, 5000}, {ContactMeasure::eta, 1e-9, 1e-9});
      solves.by_host();
      const std::vector<double> block = solves.by_blocks(Place::shared);
      for (const Place place : places) {
        EXPECT_TRUE(has_bits_of(solves.by_blocks(place), block)) << report_name_of(method);
        for (std::size_t i = 0; i < solves.results.size(); ++i) {
          const IslandResult& result = solves.results[i];
          EXPECT_EQ(result.end.reason, StopReason::converged) << report_name_of(method);
          EXPECT_LE(StopCriterion({ContactMeasure::eta, 1e-9, 1e-9}).excess_of(solves.sums[i].sums),
                    1.001);
          EXPECT_NEAR(static_cast<double>(result.end.sweeps),
                      static_cast<double>(solves.host_ends[i].sweeps),
                      5 + 0.2 * static_cast<double>(solves.host_ends[i].sweeps))
              << report_name_of(method);
        }
      }
    }
  }
}

/// With a tolerance of zero rounding stops the progress.
TEST(ContactIslandSimt, AnIslandThatGetsNoBetterGivesUp) {
  const SweepScene scene(scenes::random_local({.seed = 11, .contacts = 20}), false);
  IslandSolves<float> solves(scene, {ContactMethod::automatic, 0, 100000},
                             {ContactMeasure::eta, 0, 0});

  solves.by_blocks(Place::shared);

  EXPECT_LT(solves.results[0].end.sweeps, 100000);
  EXPECT_TRUE(solves.results[0].end.has_switched || solves.sums[0].sums.eta == 0);
}

/// With room for few events: even spaces, rising, the last one kept.
TEST(ContactIslandSimt, EventsAreThinnedOutEvenly) {
  const SweepScene scene(packed_spheres(100), false);
  IslandSolves<double> solves(scene, {ContactMethod::gauss_seidel, 0, 300},
                              {ContactMeasure::eta, 0, 0});
  solves.events = 8;
  solves.by_host();
  const std::vector<ContactEvent>& all = solves.host_logs[0];
  ASSERT_GT(all.size(), 16U);

  solves.by_blocks(Place::shared);

  const std::int64_t kept = solves.results[0].events;
  ASSERT_GE(kept, 4);
  ASSERT_LE(kept, 8);
  EXPECT_EQ(solves.logs[0].sweep, all[0].sweep);
  EXPECT_EQ(solves.logs[static_cast<std::size_t>(kept) - 1].sweep, all.back().sweep);
  std::size_t stride = 0;
  while (stride < all.size() && all[stride].sweep != solves.logs[1].sweep) ++stride;
  for (std::int64_t k = 0; k + 1 < kept; ++k) {
    EXPECT_EQ(solves.logs[static_cast<std::size_t>(k)].sweep,
              all[static_cast<std::size_t>(k) * stride].sweep);
  }
}
}  // namespace
}  // namespace tetwarp::test
