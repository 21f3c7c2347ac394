/// @file coupled_control.hpp
/// When the iteration over bodies and their contacts ends, and when the sweeps of each of its steps
/// do.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tetwarp {

struct CoupledOutcome {
  bool converged = false;
  bool is_result = false;   ///< velocities and impulses are set: converged, or those of the iterate
                            ///< with the least residual where another solver would take too long
  bool is_stopped = false;  ///< by the caller
  double residual = 0;
  std::int64_t outer_iterations = 0;
  std::int64_t sweeps = 0;  ///< or proximal steps, on a device
};

/// Of an iterate; square roots of energies.
struct CoupledError {
  double equations = 0, laws = 0;  ///< of A v = b + J^T r; of the laws
  double total = 0;                ///< of both
  double work = 0;                 ///< of the impulses

  // The norms of M^-1 and of the blocks J M^-1 J^T differ from those of A^-1. With these factors
  // the error was an upper bound of eta, by a factorization of A, on bodies of some hundred nodes
  // with E of 1e4 to 1e8 Pa, with and without adhesion.
  static constexpr double defect_factor = 8;
  static constexpr double law_factor = 2;

  /// @param defect   d . M^-1 d, d = b + J^T r - A v
  /// @param natural  sum of natural_square()
  /// @param work     r . (u - u without impulses)
  static CoupledError of(double defect, double natural, double work) {
    CoupledError error;
    error.equations = defect_factor * std::sqrt(std::max(defect, 0.0));
    error.laws = law_factor * std::sqrt(natural);
    error.total = std::hypot(error.equations, error.laws);
    error.work = std::sqrt(std::max(work, 0.0));
    return error;
  }
  /// The error of the velocities without contact, by their defect, and a little more.
  static double least(double defect) {
    return 1.01 * defect_factor * std::sqrt(std::max(defect, 0.0));
  }
};

/// Decides from the errors of successive iterates.
class CoupledControl {
 public:
  enum class Next : std::uint8_t { proceeds, converges, diverges, fails, is_stopped };
  static constexpr std::int64_t most_iterations = 1000;
  /// The factors of bodies that are bent much are too soft: the iteration then diverges, and is
  /// begun anew with half their compliance, down to this part of it.
  static constexpr double least_damping = 1.0 / 16;
  /// Of the tolerance, at which convergence is checked where the errors are no measure of it: a
  /// check takes tens of products with A.
  static constexpr double check_share = 0.2;

  /// omega of the nodes and bodies that A couples to others, in simulations.
  /// @param relaxation  ContactExpertOptions::relaxation
  static double omega(double relaxation) { return 1.3 * relaxation; }

  struct Options {
    bool has_elastic = false;     ///< bodies that are solved by their factors at rest
    bool ends_early = false;      ///< where it diverges
    double tolerance = 0;         ///< of the error, relative
    double natural_alone = 0;     ///< sum of natural_square() without impulses
    std::int64_t few_sweeps = 2;  ///< the least that an iteration takes, or little more
    double least_error = 0;       ///< CoupledError::least()
    /// The iteration ends where its least residual has not shrunk to 0.9 of it in so many errors.
    std::int64_t patience = 150;
  };

  explicit CoupledControl(const Options& options)
      : options_(options),
        least_scale_(options.least_error / options.tolerance),
        share_(options.has_elastic ? elastic_share : inner_share),
        final_share_(options.has_elastic ? final_share : 0) {}

  /// @param sweeps   of all outer iterations before; or proximal steps
  /// @param excess   () -> double, of an iterate within the tolerance: how many times the tolerance
  ///                 it is off by a closer measure; not finite where that has no answer. Where it
  ///                 is more than 1, errors have to become smaller in proportion
  template <class Excess>
  Next next(const CoupledError& error, std::int64_t sweeps, const Excess& excess) {
    const double scale = std::max(std::sqrt(options_.natural_alone) + error.work, least_scale_);
    residual_ = error.total > 0 ? error.total / scale : 0;
    is_best_ = false;
    if (!std::isfinite(error.total)) return Next::fails;
    if (error.total <= options_.tolerance * scale) {
      const double more = excess();
      if (more <= 1) return Next::converges;
      if (!std::isfinite(more) || error.total == 0) return Next::fails;  // nothing left to shrink
      options_.tolerance = 0.9 * residual_ / more;
    }
    note_growth(error.total);
    if (!note_residual()) return Next::fails;
    if (options_.ends_early && residual_ > divergence * best_) return Next::diverges;
    // With elastic bodies what the first iteration leaves is far from what the next ones do; and
    // mixed velocities fit the impulses less well than those of the last iteration alone.
    mixes_ = !options_.has_elastic || (iterations_ > 0 && error.equations > error.laws);
    set_enough(error, options_.tolerance * scale, sweeps);
    ++iterations_;
    return Next::proceeds;
  }

  /// Of the last iterate; relative.
  double residual() const { return residual_; }
  /// Whether it had the least residual so far.
  bool is_best() const { return is_best_; }
  /// Whether the error has become twice the least since this was last so: mixing with the
  /// velocities that led there would keep it up for many iterations.
  bool has_grown() const { return has_grown_; }
  /// Whether velocities of this iteration are mixed with those before by Anderson's method.
  bool mixes() const { return mixes_; }
  /// The sweeps of this iteration end where one changes the impulses by at most this, its proximal
  /// steps where the laws are off by at most this; as CoupledError.
  double enough() const { return enough_; }

 private:
  static constexpr double least_progress = 0.9;
  // Errors of iterations that converge grow by less than this at times.
  static constexpr double divergence = 30;
  // After which mixing begins anew: with 1 to 4 the landing of `candy` takes 0.78 to 0.85 of the
  // sweeps that it takes without.
  static constexpr double growth = 2;
  // Share of the error before an outer iteration that its sweeps may leave; elastic_share holds
  // with single elastic bodies.
  static constexpr double inner_share = 0.1, elastic_share = 0.005;
  // Share of the error at which the solve ends. With single elastic bodies sweeps may leave as
  // much: less would gain nothing. Cloth takes as many sweeps without this.
  static constexpr double final_share = 0.4;

  void note_growth(double total) {
    has_grown_ = total > growth * least_;
    least_ = has_grown_ ? total : std::min(least_, total);
  }

  /// @returns false if the least residual no longer shrinks
  bool note_residual() {
    is_best_ = residual_ < best_;
    if (is_best_) best_ = residual_;
    if (iterations_ == 0 || best_ <= least_progress * mark_) {
      mark_ = best_;
      marked_at_ = iterations_;
    }
    return iterations_ - marked_at_ < options_.patience;
  }

  void set_enough(const CoupledError& error, double target, std::int64_t sweeps) {
    // The change of a sweep is no bound of the error of the laws.
    if (iterations_ > 0 && sweeps - sweeps_before_ <= options_.few_sweeps &&
        error.laws > 0.9 * target) {
      final_share_ /= 2;
    }
    sweeps_before_ = sweeps;
    enough_ = std::max(share_ * error.total, final_share_ * target);
  }

  Options options_;
  double least_scale_;  ///< of the errors
  double share_, final_share_;
  double residual_ = 0, best_ = std::numeric_limits<double>::infinity(), enough_ = 0;
  double mark_ = 0;  ///< residual at the iteration `marked_at_`, when it had last shrunk enough
  double least_ = std::numeric_limits<double>::infinity();  ///< error since the last growth
  bool is_best_ = false, has_grown_ = false, mixes_ = false;
  std::int64_t iterations_ = 0, sweeps_before_ = 0, marked_at_ = 0;
};

}  // namespace tetwarp
