/// @file island_restart.cpp
/// Solves from other starts, for islands on which impulses can grow along a direction that causes
/// no velocity. With Coulomb's friction such a direction does not exclude a solution: contacts that
/// slide can release it. Methods that have followed it once do not find back; from another start
/// they often find a solution.
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "host/contact/newton/newton.hpp"
#include "host/contact/newton/pivoting.hpp"
#include "host/contact/solve/best_impulses.hpp"
#include "host/contact/solve/island_solver.hpp"
#include "host/contact/solve/method_choice.hpp"

namespace tetwarp {
namespace {
constexpr std::uint32_t pivoting_starts = 256;
constexpr int random_starts = 24;
constexpr std::int64_t steps_per_start = 50;  ///< Newton steps

/// Random impulses inside the friction cones, of a size that grows by a factor of 100 over the
/// starts.
std::vector<double> random_impulses(const ContactProblem& part, double scale, int start) {
  std::mt19937 random(static_cast<std::uint32_t>(start + 1));
  // Not a distribution of the library: its numbers differ between implementations.
  const auto uniform = [&] { return static_cast<double>(random()) / 0x1p32; };
  const double size = scale * std::pow(100.0, double{start + 0.5} / random_starts);
  std::vector<double> impulse;
  for (const double friction : part.friction) {
    const double normal = size * uniform();
    impulse.push_back(normal);
    for (int axis = 0; axis < 2; ++axis) {
      impulse.push_back(0.7 * friction * normal * (2 * uniform() - 1));
    }
  }
  return impulse;
}
}  // namespace

/// Whether the search for a direction costs less than the sweeps that are left, or than a few
/// thousand.
bool IslandSolver::searches_before_sweeps(const ContactProblem& part,
                                          const IslandOutcome& outcome) const {
  constexpr double factorizations = 60;
  constexpr std::int64_t few = 4096;
  if (options_.max_newton == 0) return false;
  const double step = sweeps_per_step(part);
  const std::int64_t left = std::max(options_.max_sweeps - outcome.sweeps, few);
  return factorizations * step < static_cast<double>(left);
}

/// Pivoting, which finds exact solutions where the laws are linear; Newton's method removes what
/// rounding has left.
/// @return  whether the island is solved
bool IslandSolver::pivot(std::int64_t i,
                         const ContactProblem& part,
                         ContactRun<double>& run,
                         IslandOutcome& outcome) {
  constexpr double close = 1e4;  ///< times the allowed error: Newton's method converges from there
  if (!FrictionPivoting::applies(part, options_)) return false;
  double* const impulse =
      run.state().impulse.data() + 3 * structure_.islands[index_of(i)].slot_begin;
  const FrictionPivoting pivoting(part, options_);
  for (std::uint32_t start = 0; start < pivoting_starts; ++start) {
    if (budget_ != nullptr && budget_->is_over()) return false;
    const std::optional<std::vector<double>> found = pivoting.solve(start);
    if (!found) continue;
    std::copy(found->begin(), found->end(), impulse);
    outcome.sums = run.measure(i);
    if (run.excess(i, outcome.sums) > close) continue;
    outcome.methods.push_back("pivoting");
    if (!run.is_done(i, outcome.sums)) polish(i, part, run, outcome, {.shared = steps_per_start});
    if (run.is_done(i, outcome.sums)) return true;
  }
  return false;
}

/// Pivoting, mass splitting and Anderson's method from zero impulses, then Newton's method from
/// random ones; leaves the best impulses.
void IslandSolver::start_again(std::int64_t i,
                               const ContactProblem& part,
                               ContactRun<double>& run,
                               IslandOutcome& outcome) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  double* const impulse = run.state().impulse.data() + 3 * island.slot_begin;
  const std::int64_t size = 3 * island.contact_count();
  BestImpulses best(impulse, size, run.excess(i, outcome.sums));
  const auto is_done = [&] {
    outcome.sums = run.measure(i);
    best.keep(impulse, run.excess(i, outcome.sums));
    return run.is_done(i, outcome.sums) || (budget_ != nullptr && budget_->is_over());
  };
  if (pivot(i, part, run, outcome)) return;
  const std::int64_t share = (options_.max_sweeps - outcome.sweeps) / 4;
  for (const ContactMethod method : {ContactMethod::mass_splitting, ContactMethod::anderson}) {
    std::fill_n(impulse, size, 0.0);
    run.sweep_on(i, outcome.sweeps + share, method);
    if (is_done()) break;
  }
  double scale = 0;
  for (std::int64_t s = island.slot_begin; s < island.slot_end; ++s) {
    const double approach = std::abs(run.system().free_velocity[index_of(3 * s)]);
    scale = std::max(scale, approach / run.system().constants[index_of(s)].block[0]);
  }
  for (int start = 0; start < random_starts && !is_done(); ++start) {
    const std::vector<double> random = random_impulses(part, scale / 10, start);
    std::copy(random.begin(), random.end(), impulse);
    outcome.sums = run.measure(i);
    polish(i, part, run, outcome, {.shared = steps_per_start});
  }
  best.restore();
  outcome.sums = run.measure(i);
}

}  // namespace tetwarp
