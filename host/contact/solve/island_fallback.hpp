/// @file island_fallback.hpp
/// What follows on an island where the first sweeps have not converged: other methods, and
/// certificates that no method can succeed.
#pragma once
#include <limits>
#include <vector>

#include "host/contact/solve/engine_result.hpp"
#include "host/contact/solve/feasibility.hpp"
#include "host/contact/solve/island_attempt.hpp"
#include "host/contact/solve/method_choice.hpp"

namespace tetwarp {

/// With the method `automatic`, in this order until the island is solved or its contacts are shown
/// to contradict each other:
///
/// 1. Sweeps, as long as they promise to end soon; then contradictions of normal offsets, as far as
///    sweeps show them soon.
/// 2. Sweeps and Newton's method in turns, each as long as it promises to be the cheaper one.
/// 3. Contradictions, by more sweeps and by a certificate.
/// 4. A direction in which impulses can grow without bound; if there is one, other starts.
/// 5. All sweeps that are left, then Newton's method as long as it improves the impulses; before
///    these sweeps, too, where all its steps cost less and neither they nor time are limited.
///
/// The method `newton` does 1, Newton's method, 3 and 4, without other starts. Methods of sweeps do
/// 3 and 4, without other starts; the certificates only where many sweeps are allowed. Islands with
/// bilateral or rolling blocks have no certificates, those with rolling blocks no Newton's method.
class IslandFallback {
 public:
  /// @param attempt  kept by the caller
  /// @param memory   of searches on islands of this problem
  /// @param result   contacts that contradict each other or that impulses grow at are noted in it
  IslandFallback(IslandAttempt& attempt, ContradictionMemory& memory, EngineResult& result)
      : attempt_(attempt), memory_(memory), result_(result) {}

  /// Sweeps of an island at first: few where the method of multipliers can follow.
  static std::int64_t first_sweeps(const HostProblem& all, std::int64_t island);

  /// Changes the impulses of the attempt and measures them.
  void run();

 private:
  static bool takes_multipliers(const HostProblem& all, std::int64_t island);
  bool is_automatic() const { return attempt_.options().method == ContactMethod::automatic; }
  bool has_newton() const {
    return is_automatic() || attempt_.options().method == ContactMethod::newton;
  }
  bool searches_before_sweeps();
  bool has_other_blocks() const;

  void certify_after_sweeps();
  void take_turns();
  void finish_automatic();
  bool ends_before_sweeps();
  void polish_while_better();
  void run_methods();
  void try_multipliers();
  void sweep_from_guess();
  void sweep_while_cheaper(double newton_sweeps, std::int64_t least);
  bool clamp_contradicting(const ContradictionSearch& search);
  bool find_contradiction();
  bool find_unbounded();

  IslandAttempt& attempt_;
  ContradictionMemory& memory_;
  EngineResult& result_;
  SweepChoice sweeps_;
  double polished_ =
      std::numeric_limits<double>::infinity();  ///< excess where Newton's method ended
  double left_ = 0;                             ///< of sweeps_left(), of the last sweeps
  std::vector<double> last_;  ///< impulses from which sweep_while_cheaper() goes on; empty: current
};

}  // namespace tetwarp
