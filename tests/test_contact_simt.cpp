/// @file test_contact_simt.cpp
/// The hand-mapped contact sweeps, run by emulation in several thread orders, give the bits of the
/// host's sweeps.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <tetwarp/error.hpp>

#include "host/contact_run.hpp"
#include "tests/contact_sweeps.hpp"

#include "tests/emulated_device.hpp"

namespace tetwarp::test {
namespace {

constexpr std::int64_t forever = std::numeric_limits<std::int64_t>::max();

ContactSystem<double> system_in(const SweepScene& scene, double) {
  return scene.system;
}
ContactSystem<float> system_in(const SweepScene& scene, float) {
  return make_float32(scene.system);
}

template <class T>
bool has_bits_of(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

/// 11 sweeps, not a multiple of how often the kernel looks, of all islands: in shared memory under
/// every schedule, in place under one.
template <class T>
void expect_equal_bits(const ContactProblem& problem,
                       ContactSwitches switches = {},
                       bool separates_islands = false) {
  constexpr std::int64_t sweeps = 11;
  const SweepScene scene(problem, separates_islands);
  const ContactSystem<T> system = system_in(scene, T{});
  const SweepTask task = scene.task({true, 0, sweeps, forever}, switches, 0);
  const std::vector<T> start(system.free_velocity.size(), T(0.001));
  const auto expect_host_bits = [&](Place place) {
    std::vector<T> best = start;
    const std::vector<SweepProgress> progress =
        EmulatedDevice(place).sweep(task, scene.structure, system, best);
    for (std::size_t i = 0; i < progress.size(); ++i) {
      const ContactIsland& island = scene.structure.islands[i];
      const HostSweeps<T> host =
          sweep_on_host(scene.structure, system, island, switches, start, progress[i].best_sweep);
      ASSERT_TRUE(has_bits_of(part_of(best, island), host.impulse))
          << "island " << i << " of " << island.contact_count() << " contacts";
      // Same terms, another tree.
      EXPECT_NEAR(progress[i].sums.eta, host.sums.eta, 1e-12 * host.sums.eta);
      EXPECT_EQ(progress[i].sums.largest, host.sums.largest);
      EXPECT_TRUE(progress[i].excess == 0 || progress[i].sweeps == sweeps);
      EXPECT_GE(progress[i].best_sweep, sweeps_per_look);
    }
  };
  simt::for_each_schedule([&](const simt::Schedule&) { expect_host_bits(Place::shared); });
  expect_host_bits(Place::global);
}

constexpr std::int64_t sizes[] = {1, 31, 32, 33, 100};

ContactProblem packed_spheres(std::int64_t contacts, const scenes::Glue& glue = {}) {
  return first_contacts(scenes::sphere_packing({.seed = 3, .edge = 4, .glue = glue}), contacts);
}

TEST(ContactSweepSimt, LocalProblemsHaveTheBitsOfTheHost) {
  for (const std::int64_t contacts : sizes) {
    expect_equal_bits<double>(scenes::random_local({.seed = 5, .contacts = contacts}));
    expect_equal_bits<float>(scenes::random_local({.seed = 6, .contacts = contacts}));
  }
}

TEST(ContactSweepSimt, RigidBodiesHaveTheBitsOfTheHost) {
  for (const std::int64_t contacts : sizes) {
    expect_equal_bits<double>(packed_spheres(contacts));
    expect_equal_bits<float>(packed_spheres(contacts));
    expect_equal_bits<double>(first_contacts(scenes::box_stack({.boxes = 25}), contacts));
  }
}

/// More contacts of one color than a block has threads.
TEST(ContactSweepSimt, WideColorsHaveTheBitsOfTheHost) {
  const ContactProblem problem = scenes::random_local({.seed = 7, .contacts = 700});
  const ContactStructure structure = make_structure(problem, {.converged_islands = false});
  EXPECT_GT(structure.color_start[1] - structure.color_start[0], sweep_threads);

  expect_equal_bits<double>(problem);
}

TEST(ContactSweepSimt, EveryLawAndRuleHasTheBitsOfTheHost) {
  const scenes::Glue glue = {1e6, 0.7};
  for (const ContactSwitches switches :
       {ContactSwitches{true, false}, ContactSwitches{false, true}, ContactSwitches{true, true}}) {
    expect_equal_bits<double>(
        scenes::random_local({.seed = 8, .contacts = 33, .asymmetry = 1e-3, .glue = glue}),
        switches);
    expect_equal_bits<double>(packed_spheres(33, glue), switches);
  }
}

TEST(ContactSweepSimt, IslandsSideBySideHaveTheBitsOfTheHost) {
  const ContactProblem spheres = scenes::sphere_packing({.seed = 9, .edge = 5, .kept = 0.2});
  EXPECT_GT(make_structure(spheres, {}).contact_islands, 5);

  expect_equal_bits<double>(spheres, {}, true);
  expect_equal_bits<float>(spheres, {}, true);
}

TEST(ContactSweepSimt, AnIslandStopsWhereItsRuleHolds) {
  const SweepScene scene(scenes::random_local({.seed = 10, .contacts = 60}), true);
  for (const ContactMeasure measure : {ContactMeasure::eta, ContactMeasure::fclib}) {
    const StopRule rule{measure, 1e-7, 1e-7};
    const SweepTask task =
        scene.task({measure == ContactMeasure::eta, 1e-7, 5000, forever}, {}, rule.allowed);
    std::vector<double> best(scene.system.free_velocity.size(), 0.0);

    const auto progress = EmulatedDevice().sweep(task, scene.structure, scene.system, best);

    for (std::size_t i = 0; i < progress.size(); ++i) {
      const HostSweeps<double> host =
          sweep_on_host(scene.structure, scene.system, scene.structure.islands[i], {}, best, 0);
      EXPECT_LE(rule.excess_of(host.sums), 1.0 + 1e-6);
      EXPECT_NEAR(rule.excess_of(host.sums), progress[i].excess, 1e-6);
      EXPECT_LT(progress[i].sweeps, 5000);
      EXPECT_EQ(progress[i].sweeps, progress[i].best_sweep);
    }
  }
}

/// Rounding ends every progress towards no error at all.
TEST(ContactSweepSimt, AnIslandThatGetsNoBetterGivesUp) {
  const SweepScene scene(scenes::random_local({.seed = 11, .contacts = 20}), false);
  std::vector<float> best(scene.system.free_velocity.size(), 0.0f);

  const auto progress = EmulatedDevice().sweep(scene.task({true, 0, 100000, 40}, {}, 0),
                                               scene.structure, make_float32(scene.system), best);

  EXPECT_LT(progress[0].sweeps, 100000);
  EXPECT_GE(progress[0].sweeps, progress[0].drop_sweep + (progress[0].excess > 1 ? 40 : 0));
}

TEST(ContactSweepSimt, LargeIslandsAreSummedInAFixedTree) {
  const SweepScene scene(scenes::random_local({.seed = 12, .contacts = 2500}), false);
  const ContactIsland& island = scene.structure.islands[0];
  std::vector<double> impulse(scene.system.free_velocity.size(), 0.001);
  const HostSweeps<double> host =
      sweep_on_host(scene.structure, scene.system, island, {}, impulse, 0);
  std::vector<double> velocity(impulse.size());
  const DelassusSweepBody<double> body = {scene.system.delassus_view(scene.structure),
                                          view_of(scene.system.constants),
                                          {},
                                          {},
                                          view_of(impulse)};
  const auto term = term_of(body, view_of(scene.system.free_velocity), view_of(velocity));
  std::vector<ContactSums> first;

  simt::for_each_schedule([&](const simt::Schedule&) {
    std::vector<ContactSums> sums(static_cast<std::size_t>(sums_needed(island.contact_count())));
    contact_sums(nullptr, island.slot_begin, island.slot_end, term, view_of(sums));
    if (first.empty()) first = sums;
    EXPECT_EQ(sums.back().eta, first.back().eta);
    EXPECT_NEAR(sums.back().eta, host.sums.eta, 1e-12 * host.sums.eta);
    EXPECT_NEAR(sums.back().fclib, host.sums.fclib, 1e-12 * host.sums.fclib);
    EXPECT_EQ(sums.back().deepest, host.sums.deepest);
    EXPECT_EQ(sums.back().largest_contact, host.sums.largest_contact);
  });
}

TEST(SweepProgress, NeverTakesANanForTheBest) {
  SweepProgress progress;
  ContactSums sums;
  sums.eta = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(progress.take(sums, 0, {true, 0, 100, 50}, 1));
  sums.eta = 4;
  EXPECT_TRUE(progress.take(sums, 8, {true, 0, 100, 50}, 1));
  EXPECT_FALSE(progress.is_done);
  sums.eta = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(progress.take(sums, 16, {true, 0, 100, 50}, 1));

  EXPECT_EQ(progress.excess, 2);
  EXPECT_EQ(progress.best_sweep, 8);
}

/// Both precisions end within what was asked, judged on the host in float64.
TEST(SweepOnDevice, SolvesEveryIslandToItsRule) {
  const SweepScene scene(scenes::random_local({.seed = 13, .contacts = 40, .neighbors = 2}), true);
  const std::size_t islands = static_cast<std::size_t>(scene.structure.contact_islands);
  for (const ContactPrecision precision : {ContactPrecision::float64, ContactPrecision::float32}) {
    ContactOptions options;
    options.precision = precision;
    options.tolerance = 1e-4;
    const std::vector<StopRule> rules(islands, {ContactMeasure::eta, 1e-4, 1e-4});
    std::vector<IslandOutcome> outcomes(islands);
    EmulatedDevice device;

    const std::vector<double> impulse =
        sweep_on_device(device, options, scene.structure, scene.system, rules, {}, outcomes);

    for (std::size_t i = 0; i < islands; ++i) {
      const ContactIsland& island = scene.structure.islands[i];
      const HostSweeps<double> host =
          sweep_on_host(scene.structure, scene.system, island, {}, impulse, 0);
      EXPECT_LE(rules[i].excess_of(host.sums), 1.01);  // float32 judged itself a little otherwise
      EXPECT_EQ(outcomes[i].reason, StopReason::converged);
      EXPECT_EQ(outcomes[i].contact_updates, outcomes[i].sweeps * island.contact_count());
    }
  }
}

TEST(SweepOnDevice, LeavesCoupledIslandsAlone) {
  const SweepScene scene(scenes::elastic_slab({.cubes = {3, 3, 2}, .contacts = 9}), true);
  std::vector<IslandOutcome> outcomes(1);
  EmulatedDevice device;
  const std::vector<double> start(scene.system.free_velocity.size(), 0.5);

  EXPECT_EQ(
      sweep_on_device(device, {}, scene.structure, scene.system, {StopRule{}}, start, outcomes),
      start);

  EXPECT_TRUE(outcomes[0].methods.empty());
}

}  // namespace
}  // namespace tetwarp::test
