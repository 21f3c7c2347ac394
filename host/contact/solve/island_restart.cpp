/// @file island_restart.cpp
/// The starts, and the methods that are run from them.
#include "host/contact/solve/island_restart.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "host/contact/newton/pivoting.hpp"

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

/// Pivoting, which finds exact solutions where the laws are linear; Newton's method removes what
/// rounding has left.
/// @return  whether the island is solved
bool IslandRestart::pivot() {
  constexpr double close = 1e4;  ///< times the allowed error: Newton's method converges from there
  if (!FrictionPivoting::applies(attempt_.part(), attempt_.options())) return false;
  const FrictionPivoting pivoting(attempt_.part(), attempt_.options());
  for (std::uint32_t start = 0; start < pivoting_starts; ++start) {
    if (attempt_.is_over()) return false;
    const std::optional<std::vector<double>> found = pivoting.solve(start);
    if (!found) continue;
    std::copy(found->begin(), found->end(), attempt_.impulse());
    attempt_.measure();
    if (attempt_.excess() > close) continue;
    attempt_.outcome().methods.push_back("pivoting");
    if (!attempt_.is_done()) attempt_.polish({.shared = steps_per_start});
    if (attempt_.is_done()) return true;
  }
  return false;
}

/// Measures the current impulses, and keeps them if they are the best.
bool IslandRestart::is_finished() {
  attempt_.measure();
  best_.keep(attempt_.impulse(), attempt_.excess());
  return attempt_.is_done() || attempt_.is_over();
}

/// Newton's method from random impulses, scaled by those that single contacts need.
void IslandRestart::polish_random_starts() {
  const ContactSystem<double>& system = attempt_.run().system();
  const ContactIsland& island = attempt_.island();
  double scale = 0;
  for (std::int64_t s = island.slot_begin; s < island.slot_end; ++s) {
    const double approach = std::abs(system.free_velocity[index_of(3 * s)]);
    scale = std::max(scale, approach / system.constants[index_of(s)].block[0]);
  }
  for (int start = 0; start < random_starts && !is_finished(); ++start) {
    const std::vector<double> random = random_impulses(attempt_.part(), scale / 10, start);
    std::copy(random.begin(), random.end(), attempt_.impulse());
    attempt_.measure();
    attempt_.polish({.shared = steps_per_start});
  }
}

void IslandRestart::run() {
  if (pivot()) return;
  polish_random_starts();
  best_.restore();
  attempt_.measure();
}

}  // namespace tetwarp
