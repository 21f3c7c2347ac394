/// @file island_restart.hpp
/// Solves from other starts, for islands on which impulses can grow along a direction that causes
/// no velocity (ImpulseDirection).
#pragma once
#include "host/contact/solve/best_impulses.hpp"
#include "host/contact/solve/island_attempt.hpp"

namespace tetwarp {

/// With Coulomb's friction such a direction does not exclude a solution: contacts that slide can
/// release it. Methods that have followed it once do not find back; from another start they often
/// find a solution.
class IslandRestart {
 public:
  /// @param attempt  kept by the caller
  explicit IslandRestart(IslandAttempt& attempt)
      : attempt_(attempt), best_(attempt.impulse(), attempt.size(), attempt.excess()) {}

  /// Pivoting, then Newton's method from random impulses, until one of them solves the island.
  /// Leaves the best impulses.
  void run();

 private:
  bool pivot();
  bool is_finished();
  void polish_random_starts();

  IslandAttempt& attempt_;
  BestImpulses best_;
};

}  // namespace tetwarp
