#include "host/simulate/contact/two_level_solver.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/exec/contact_exec_cpu.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t most_iterations = 1000;
// An iteration ends whose least residual has not shrunk to `least_progress` times in so many
// iterations.
constexpr std::int64_t patience = 150;
constexpr double least_progress = 0.9;
// Multiplications of all sweeps of a solve, after which it ends: about a second.
constexpr std::int64_t most_operations = 1'000'000'000;
// Up to these sizes the contact solver is quick where the iteration fails.
constexpr std::int64_t small_contacts = 256, small_rows = 128;
constexpr std::int32_t chunk_rows = 64;
// Of the error before an outer iteration, left by its sweeps; with single elastic bodies.
constexpr double inner_share = 0.002, elastic_share = 0.005;
// Of the error at which the solve ends: with single elastic bodies sweeps leave as much, as less
// would gain nothing. Cloth takes as many sweeps without it.
constexpr double final_share = 0.4;
// The factors of bodies that are bent much are too soft: the iteration then diverges, and is begun
// anew with half their compliance. Errors of iterations that converge grow by less than
// `divergence` at times.
constexpr double divergence = 30, least_damping = 1.0 / 16;
// The norms of M^-1 and of the blocks J M^-1 J^T differ from those of A^-1. With these factors the
// error was an upper bound of eta, by a factorization of A, on bodies of some hundred nodes with E
// of 1e4 to 1e8 Pa, with and without adhesion.
constexpr double defect_factor = 8;
constexpr double law_factor = 2;

/// At which change of the impulses the sweeps of an outer iteration end.
class SweepEnd {
 public:
  explicit SweepEnd(bool has_elastic)
      : share_(has_elastic ? elastic_share : inner_share), final_(has_elastic ? final_share : 0) {}

  /// @param target  error at which the solve ends
  /// @param sweeps  of all outer iterations before
  double next(const TwoLevelError& error, double target, std::int64_t sweeps) {
    // The change of a sweep is no bound of the error of the laws.
    if (iterations_++ > 0 && sweeps - before_ <= 2 && error.laws > 0.9 * target) final_ /= 2;
    before_ = sweeps;
    return std::max(share_ * error.total, final_ * target);
  }

 private:
  double share_, final_;
  std::int64_t iterations_ = 0, before_ = 0;
};

}  // namespace

TwoLevelSolver::TwoLevelSolver(const Model& model,
                               const ContactOptions& options,
                               std::shared_ptr<RestFactors> factors)
    : model_(model),
      options_(options),
      switches_{options.law == FrictionLaw::pyramid, options.rule == AdhesionRule::restrictive},
      threads_(thread_count(options.threads)),
      relaxation_(1.3 * options.relaxation),
      elastic_(factors ? std::move(factors) : std::make_shared<RestFactors>(model)),
      blocks_(threads_) {}

/// Parts of islands that one task takes; both rows of a rigid body are in one.
void TwoLevelSolver::list_chunks(const SystemRows& rows) {
  chunks_.clear();
  for (std::size_t i = 0; i < islands_.list().size(); ++i) {
    const SolvedIsland& island = islands_.list()[i];
    for (std::int32_t row = island.row_begin; row < island.row_end;) {
      std::int32_t end = std::min(row + chunk_rows, island.row_end);
      if (end < island.row_end && rows.pair[end] == 2) ++end;
      chunks_.push_back({row, end, static_cast<std::int32_t>(i)});
      row = end;
    }
  }
  squares_.resize(chunks_.size());
}

/// Sets the contacts in the metric M, and starts from the velocities without contact.
void TwoLevelSolver::prepare(const StepSystem& system,
                             const std::vector<std::int32_t>& contacts,
                             const ContactRows& rows,
                             const ContactProblem& laws,
                             const std::vector<Point3>& velocity,
                             const std::vector<Point3>& change) {
  const SystemRows& all = system.rows;
  const std::int64_t numbers = 3 * std::int64_t{all.count};
  list_chunks(all);
  inverse_.resize(
      index_of(9 * std::int64_t{all.unknown_count} + 36 * std::int64_t{model_.rigid_count}));
  diagonal_ = {all.pair,
               all.block_of,
               all.unknown_count,
               model_.node_count,
               {inverse_.data(), static_cast<std::int64_t>(inverse_.size())}};
  for (auto* values : {&x_, &product_, &force_, &weights_, &pull_, &moved_}) {
    values->resize(index_of(numbers));
  }
  y_.resize(index_of(numbers + elastic_.size()));
  const RowInvertBody<double> invert{all, system.values, diagonal_};
  std::fill(weights_.begin(), weights_.end(), 0.0);
  parallel_tasks(threads_, static_cast<std::int64_t>(chunks_.size()), [&](std::int64_t c) {
    const Chunk& chunk = chunks_[index_of(c)];
    for (std::int32_t row = chunk.row_begin; row < chunk.row_end; ++row) {
      invert(row);
      const double* const own = system.values.data + 9 * std::int64_t{all.diagonal[row]};
      for (int i = 0; i < 3; ++i) weights_[index_of(3 * std::int64_t{row} + i)] = own[4 * i];
    }
  });
  for (std::int32_t row = 0; row < all.count; ++row) {
    for (std::size_t i = 0; i < 3; ++i) {
      x_[3 * index_of(row) + i] = velocity[index_of(all.block_of[row])][i];
      force_[3 * index_of(row) + i] = system.load[3 * std::int64_t{row} + static_cast<int>(i)];
    }
  }
  blocks_.set(system, islands_, elastic_, rows, contacts, laws, diagonal_, relaxation_);
  std::copy(x_.begin(), x_.end(), y_.begin());
  impulse_ = laws.impulse_guess;
  for (std::size_t c = 0; c < impulse_.size() / 3; ++c) impulse_[3 * c] += blocks_.preload()[c];
  contact_velocity_.resize(impulse_.size());
  free_.resize(impulse_.size());
  blocks_.velocities_of_rows(x_.data(), free_.data());
  least_error_ = 1.01 * defect_factor * std::sqrt(std::max(step(system), 0.0));
  if (change.size() != velocity.size()) return;
  for (const Chunk& chunk : chunks_) {
    for (std::int32_t row = chunk.row_begin; row < chunk.row_end; ++row) {
      const Point3& own = change[index_of(all.block_of[row])];
      for (std::size_t i = 0; i < 3; ++i) x_[3 * index_of(row) + i] += own[i];
    }
  }
}

/// The error of r and v = x.
TwoLevelError TwoLevelSolver::find_error(double defect) {
  blocks_.velocities_of_rows(x_.data(), contact_velocity_.data());
  const TouchingSums sums =
      blocks_.measure(switches_, impulse_.data(), contact_velocity_.data(), free_.data());
  TwoLevelError error;
  error.equations = defect_factor * std::sqrt(std::max(defect, 0.0));
  error.laws = law_factor * std::sqrt(sums.natural);
  error.total = std::hypot(error.equations, error.laws);
  error.work = std::sqrt(std::max(sums.work, 0.0));
  return error;
}

/// Copies the iterate with the least residual. @returns false if it no longer shrinks
bool TwoLevelSolver::keep_best(double residual, std::int64_t iterations) {
  if (residual < best_.residual) {
    best_.residual = residual;
    best_.x = x_;
    best_.impulse = impulse_;
  }
  if (iterations == 0 || best_.residual <= least_progress * best_.mark) {
    best_.mark = best_.residual;
    best_.marked_at = iterations;
  }
  return iterations - best_.marked_at < patience;
}

void TwoLevelSolver::take_best(TwoLevelOutcome& outcome) {
  outcome.residual = best_.residual;
  x_ = best_.x;
  impulse_ = best_.impulse;
  blocks_.velocities_of_rows(x_.data(), contact_velocity_.data());
}

/// Iterates from what prepare() has set.
/// @param ends_early  where it diverges
TwoLevelSolver::End TwoLevelSolver::iterate(const StepSystem& system,
                                            bool ends_early,
                                            TwoLevelOutcome& outcome) {
  const std::int64_t begin = 3 * std::int64_t{chunks_.front().row_begin};
  const std::int64_t size = 3 * std::int64_t{chunks_.back().row_end} - begin;
  CpuContactExec exec(threads_);
  using Mixer = AndersonMixer<CpuContactExec, double>;
  mixed_.resize(index_of(Mixer::columns * size));
  Mixer mixer(exec, {weights_.data() + begin, size}, {mixed_.data(), Mixer::columns * size});
  contact_velocity_.assign(impulse_.size(), 0.0);  // no impulses
  const double alone = std::sqrt(
      blocks_.measure(switches_, contact_velocity_.data(), free_.data(), free_.data()).natural);
  best_.residual = std::numeric_limits<double>::infinity();
  const bool has_elastic = !elastic_.bodies().empty();
  SweepEnd sweep_end(has_elastic);
  for (std::int64_t iterations = 0; outcome.outer_iterations < most_iterations; ++iterations) {
    blocks_.add_impulses(system.load, impulse_.data(), force_.data());
    const TwoLevelError error = find_error(step(system));
    const double scale = std::max(alone + error.work, least_error_ / options_.tolerance);
    const double target = options_.tolerance * scale;
    outcome.residual = error.total > 0 ? error.total / scale : 0;
    if (!std::isfinite(error.total)) return End::fails;
    if (error.total <= target) return End::converges;
    if (!keep_best(outcome.residual, iterations)) return End::fails;
    if (ends_early && outcome.residual > divergence * best_.residual) return End::diverges;
    if (blocks_.operations() > most_operations) return End::fails;
    stepped_ = impulse_;
    outcome.sweeps += sweep(sweep_end.next(error, target, outcome.sweeps));
    ++outcome.outer_iterations;
    if (options_.progress && !options_.progress({clock_.seconds(), outcome.sweeps, 0})) {
      return End::is_stopped;
    }
    add_elastic();
    const View<const double> before{x_.data() + begin, size};
    const View<double> image{y_.data() + begin, size};
    // With elastic bodies what the first iteration leaves is far from what the next ones do; and
    // mixed velocities fit the impulses less well than those of the last iteration alone.
    if (!has_elastic || (iterations > 0 && error.equations > error.laws)) {
      mixer.observe(before, image);
      mixer.advance(before, image);
    }
    std::copy_n(y_.data() + begin, size, x_.data() + begin);
  }
  return End::fails;
}

TwoLevelOutcome TwoLevelSolver::solve(const StepSystem& system,
                                      const ModelState& state,
                                      const ContactIslands& islands,
                                      const ContactRows& rows,
                                      const std::vector<std::uint8_t>& takes,
                                      const std::vector<std::int32_t>& contacts,
                                      const ContactProblem& laws,
                                      const std::vector<Point3>& change,
                                      std::vector<Point3>& velocity) {
  clock_ = {};
  elastic_.choose(system.rows, islands, takes, rows, contacts);
  islands_.set(system.rows, islands, takes, elastic_);
  TwoLevelOutcome outcome;
  End end = End::converges;
  for (double damping = 1; damping >= least_damping; damping /= 2) {
    elastic_.set(state, laws.adhesion.time_step, 3 * std::int64_t{system.rows.count}, damping,
                 threads_);
    prepare(system, contacts, rows, laws, velocity, change);
    const bool can_be_damped = !elastic_.bodies().empty() && damping > least_damping;
    if (!chunks_.empty()) end = iterate(system, can_be_damped, outcome);
    if (end != End::diverges) break;
  }
  if (chunks_.empty()) {
    outcome.converged = outcome.is_result = true;
    return outcome;
  }
  if (end == End::is_stopped) return outcome;
  outcome.converged = end == End::converges;
  const bool is_small = blocks_.count() <= small_contacts &&
                        chunks_.back().row_end - chunks_.front().row_begin <= small_rows;
  outcome.is_result = outcome.converged || (!is_small && std::isfinite(best_.residual));
  if (!outcome.is_result) return outcome;
  if (!outcome.converged) take_best(outcome);
  for (const Chunk& chunk : chunks_) {
    for (std::int32_t row = chunk.row_begin; row < chunk.row_end; ++row) {
      const std::size_t block = index_of(system.rows.block_of[row]);
      for (std::size_t i = 0; i < 3; ++i) {
        velocity[block][i] = x_[3 * index_of(row) + i];
      }
    }
  }
  for (std::size_t c = 0; c < impulse_.size() / 3; ++c) impulse_[3 * c] -= blocks_.preload()[c];
  return outcome;
}

}  // namespace tetwarp
