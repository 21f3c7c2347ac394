/// @file two_level_sweeps.hpp
/// The accelerated sweeps of an iteration of a TwoLevelSolver.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "host/simulate/solve/problem/following_motion.hpp"
#include "host/simulate/solve/two_level/touching_sweep.hpp"

namespace tetwarp {

/// Changes impulses r of contacts, and y by M^-1 J^T of the change of r.
class TwoLevelSweeps {
 public:
  /// @param blocks  kept by the caller
  TwoLevelSweeps(const TouchingBlocks& blocks, ContactSwitches switches, int threads)
      : blocks_(blocks), threads_(threads), sweep_(blocks, switches, threads) {}

  /// Call after TouchingBlocks::set().
  void set(const ElasticSpace& elastic);

  /// Sweeps until one over all contacts of a list changes their impulses by at most `enough` in the
  /// norm of their energy.
  /// @param working  contacts that have an impulse or are off their law; sorted by this
  /// @param y        in and out, as TouchingBlocks has it
  /// @param impulse  in and out, [3 contacts]
  /// @param goes_on  (sweeps): false ends them
  /// @returns the sweeps
  std::int64_t run(std::vector<std::int32_t>& working,
                   double enough,
                   std::vector<double>& y,
                   std::vector<double>& impulse,
                   const std::function<bool(std::int64_t)>& goes_on);
  /// Multiplications of all sweeps since set().
  std::int64_t operations() const { return sweep_.operations(); }

 private:
  /// What run() changes, and how far it has come.
  struct Progress {
    double* y;
    double* impulse;
    double enough;
    const std::function<bool(std::int64_t)>& goes_on;
    std::int64_t sweeps;
  };

  std::int64_t most_sweeps() const;
  bool is_over(const Progress& progress) const;
  double sweep_all(const std::vector<std::int32_t>& working, const Progress& progress);
  void list_changing(const std::vector<std::int32_t>& working, const Progress& progress);
  void sweep_listed(const std::vector<std::int32_t>& list, Progress& progress);
  template <class Accelerator, class Follow>
  void sweep_accelerated(const std::vector<std::int32_t>& list,
                         const Follow& follow,
                         Progress& progress);
  void gather_impulses(const std::vector<std::int32_t>& list, const double* impulse);
  void scatter_impulses(const std::vector<std::int32_t>& list, double* impulse) const;

  const TouchingBlocks& blocks_;
  int threads_;
  TouchingSweep sweep_;
  bool has_elastic_ = false;  ///< bodies that are solved by their factors at rest
  // Impulses of a list of contacts, [3 list]: before a sweep, after it, as before but where an
  // accelerator has changed them since.
  std::vector<double> before_, swept_, unaccelerated_;
  std::vector<double> listed_diagonal_, accelerated_;  ///< of the accelerator
  std::vector<std::int64_t> moved_places_;
  FollowingMotion motion_;
  std::vector<std::int32_t> changing_;  ///< contacts with impulses in groups that still change
  std::vector<double> group_squares_;   ///< [groups] squares of changes
};

}  // namespace tetwarp
