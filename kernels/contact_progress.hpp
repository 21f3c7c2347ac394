/// @file contact_progress.hpp
/// How the sweeps of one island go: when they end, and which impulses were the best.
#pragma once
#include <cstdint>

#include "kernels/contact_residual.hpp"

namespace tetwarp {

constexpr std::int64_t sweep_contacts = 2048;  ///< larger islands are worth a whole device

/// When the sweeps of all islands end.
struct SweepLimit {
  bool by_eta = true;  ///< the error is that of eta; else FCLIB's
  double tolerance = 0;
  std::int64_t max_sweeps = 0;
  std::int64_t patience = 0;  ///< sweeps without a drop of the error by a tenth
};

/// One island to sweep, as places in the arrays of all.
struct SweepIsland {
  std::int64_t slot_begin, slot_end;    ///< contacts
  std::int64_t color_begin, color_end;  ///< entries of color_start
  std::int64_t dof_begin, dof_end;      ///< none in local form
  double allowed;  ///< error that may remain, besides tolerance * sqrt(r . (u - q)) for eta

  TETWARP_HD std::int64_t contact_count() const { return slot_end - slot_begin; }
  /// Numbers that its sweeps change: impulses, velocities of bodies.
  TETWARP_HD std::int64_t value_count() const { return 3 * contact_count() + dof_end - dof_begin; }
};

/// What became of the sweeps of an island.
struct SweepProgress {
  ContactSums sums;             ///< of the best impulses
  double excess = 1e300;        ///< their error over what may remain; at most 1: converged
  std::int64_t sweeps = 0;      ///< in all
  std::int64_t best_sweep = 0;  ///< after which the best impulses were seen
  double drop_excess = 1e300;
  std::int64_t drop_sweep = 0;
  bool is_done = false;

  /// Takes the residual measured after `swept` sweeps. True: the impulses are the best so far (a
  /// NaN never is).
  TETWARP_HD bool take(const ContactSums& measured,
                       std::int64_t swept,
                       const SweepLimit& limit,
                       double allowed) {
    const double error = sqrt(limit.by_eta ? measured.eta : measured.fclib);
    const double work = limit.by_eta ? sqrt(max_of(measured.work, 0.0)) : 0.0;
    const double ratio = error == 0 ? 0 : error / max_of(allowed + limit.tolerance * work, 1e-300);
    const bool is_best = ratio < excess;
    sweeps = swept;
    if (is_best) {
      excess = ratio;
      sums = measured;
      best_sweep = swept;
    }
    if (excess < 0.9 * drop_excess) {
      drop_excess = excess;
      drop_sweep = swept;
    }
    is_done = excess <= 1 || swept >= limit.max_sweeps || swept - drop_sweep >= limit.patience;
    return is_best;
  }
};

}  // namespace tetwarp
