/// @file test_races_simt.cpp
/// Races of kernels, found by the thread sanitizer on the emulated device: none in the solves of
/// islands by warps, blocks and grids, and some as soon as one of their barriers orders nothing.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "tests/emulated/check_of_step.hpp"
#include "tests/emulated/gradient_rows.hpp"
#include "tests/emulated/island_solves.hpp"
#include "tests/emulated/race_reports.hpp"
#include "tests/emulated/simt_kernels.cuh"
#include "tests/support/contact/contact_methods.hpp"

namespace tetwarp::test {
namespace {

template <class Kernel, class... Args>
int races_of(Kernel kernel, unsigned blocks, unsigned threads, Args... args) {
  take_races();
  launch(nullptr, kernel, blocks, threads, 0, args...);
  return take_races();
}

TEST(Races, AMissingBarrierIsFoundInOneOrderOfThreads) {
  std::vector<unsigned> out(32);
  EXPECT_EQ(races_of(neighbor_kernel<true>, 1, 32, out.data()), 0);
  EXPECT_GT(races_of(neighbor_kernel<false>, 1, 32, out.data()), 0);
  const std::vector<int> values(1000, 1);
  int sum = 0;
  EXPECT_EQ(races_of(sum_kernel<true>, 8, 128, values.data(), 1000, &sum), 0);
  EXPECT_GT(races_of(sum_kernel<false>, 8, 128, values.data(), 1000, &sum), 0);
}

/// All lanes have read when the shuffle returns, but nothing orders the write after it.
TEST(Races, ShufflesOrderNothing) {
  std::vector<int> out(32);
  EXPECT_EQ(races_of(overwrite_kernel<true>, 1, 32, out.data()), 0);
  EXPECT_GT(races_of(overwrite_kernel<false>, 1, 32, out.data()), 0);
}

ContactProblem small_local(std::int64_t neighbors = 3) {
  return scenes::random_local({.seed = 12, .contacts = 34, .neighbors = neighbors});
}
ContactProblem few_spheres() {
  return first_contacts(scenes::sphere_packing({.seed = 3, .edge = 4, .glue = {1e6, 0.7}}), 30);
}

template <class T>
void solve_by_teams(const ContactProblem& problem, ContactMethod method, ContactSwitches switches) {
  const SweepScene scene(problem, false);
  IslandSolves<T> solves(scene, {method, 0.5, 6}, {ContactMeasure::eta, 0, 0});
  solves.switches = switches;
  solves.freezes = method == ContactMethod::gauss_seidel;
  for (const Place place : {Place::shared, Place::shared_by_warps}) solves.by_blocks(place);
  solves.by_grid(2);
}

TEST(Races, IslandsOfContactsHaveNone) {
  for (const ContactMethod method : methods) {
    SCOPED_TRACE(report_name_of(method));
    solve_by_teams<double>(small_local(), method, {});
  }
  solve_by_teams<double>(few_spheres(), ContactMethod::gauss_seidel, {true, true});
}

TEST(LongRaces, IslandsOfContactsHaveNone) {
  for (const ContactMethod method : methods) {
    SCOPED_TRACE(report_name_of(method));
    solve_by_teams<double>(small_local(), method, {});
    solve_by_teams<double>(few_spheres(), method, {true, true});
    solve_by_teams<float>(few_spheres(), method, {});
  }
  solve_by_teams<double>(small_local(60), ContactMethod::gauss_seidel, {});
}

template <class T>
void iterate_by_teams() {
  GradientRows<T> rows(200);
  rows.template by_block<128>(1e-3);
  rows.template by_block<512>(1e-3);
  rows.by_grid(1e-3, 2);
}

TEST(Races, ConjugateGradientsHaveNone) {
  iterate_by_teams<double>();
  iterate_by_teams<float>();
}

TEST(Races, ChecksOfConvergenceHaveNone) {
  CheckOfStep check(40);
  EXPECT_GT(check.run(2, 3).progress.iterations, 3);
}

/// Takes the order from one barrier after the other, by their lines.
/// @param fewest  barriers that `run` has at least
void expect_all_barriers_needed(std::size_t fewest, const std::function<void()>& run) {
  simt::BarrierLines& lines = simt::barrier_lines();
  lines.seen.clear();
  run();
  EXPECT_EQ(take_races(), 0);
  const std::set<int> all = lines.seen;
  EXPECT_GE(all.size(), fewest);
  for (const int line : all) {
    lines.without_order = line;  // until the first report
    run();
    lines.without_order = 0;
    EXPECT_GT(take_races(), 0) << "barrier in line " << line;
  }
}

/// The end of a stage, the sum, the decision of Anderson's method.
TEST(LongRaces, AllBarriersOfAWarpAreNeeded) {
  const SweepScene scene(small_local(), false);
  expect_all_barriers_needed(3, [&] {
    IslandSolves<float> solves(scene, {ContactMethod::automatic, 1e-3, 120},
                               {ContactMeasure::eta, 0, 0});
    solves.measures = false;
    solves.by_blocks(Place::shared_by_warps);
  });
}
TEST(LongRaces, AllBarriersOfABlockAreNeeded) {
  const SweepScene scene(small_local(), false);
  expect_all_barriers_needed(4, [&] {
    IslandSolves<double> solves(scene, {ContactMethod::automatic, 1e-3, 12},
                                {ContactMeasure::eta, 0, 0});
    solves.by_blocks(Place::shared);
  });
  GradientRows<double> rows(200);
  expect_all_barriers_needed(3, [&] { rows.by_block<128>(1e-3); });
}
TEST(LongRaces, AllBarriersOfAGridAreNeeded) {
  const SweepScene scene(small_local(60), false);
  GradientRows<double> rows(200);
  expect_all_barriers_needed(5, [&] {
    IslandSolves<double> solves(scene, {ContactMethod::automatic, 1e-3, 6},
                                {ContactMeasure::eta, 0, 0});
    solves.by_grid(2);
    rows.by_grid(1e-3, 2);  // sums without other stages between them
  });
}

/// After each test no race is left that it did not take.
class NoRaces : public testing::EmptyTestEventListener {
  void OnTestEnd(const testing::TestInfo&) override { EXPECT_EQ(take_races(), 0); }
};

const bool is_listening = [] {
  testing::UnitTest::GetInstance()->listeners().Append(new NoRaces);
  return true;
}();

}  // namespace
}  // namespace tetwarp::test
