/// @file residual_check.hpp
/// The residual eta of an iterate of the two-level iteration, from velocities that its impulses
/// cause; on any executor.
///
/// The errors of the iteration are measured in M (compliant_body.hpp). Of bodies that are joined to
/// others, and of cloth, M^-1 is far below A^-1, so that these errors are too small. Here
/// velocities v' with
///
///     A v' = b + J^T r
///
/// are found by conjugate gradients with M^-1 as preconditioner, to about a fifth of the way in the
/// norm of A, and eta is estimated as by the contact solver (contact_bound.hpp), whose blocks of
/// J A^-1 J^T are those of M^-1 at least. Tests compare it with a factorization of A and allow 1.5
/// times the estimate.
#pragma once
#include <cstdint>

#include "kernels/base/conjugate_gradients.hpp"
#include "kernels/contact/contact_bound.hpp"
#include "kernels/contact/touching_rows.hpp"

namespace tetwarp {

struct ResidualCheckLimits {
  double tolerance = 0;    ///< of eta
  double least_scale = 0;  ///< of the energies that eta is relative to, at least [sqrt(J)]

  /// No iterations where the defect, squared in the norm of M^-1, is at most this, as after steps
  /// of Newton's method: A^-1 is hardly more than a million times M^-1.
  /// @param work  of the impulses, r . (u - u without impulses) [J]
  TETWARP_HD double negligible(double work) const {
    constexpr double least_share = 1e-4;  // of the tolerance
    return square_of(least_share * tolerance) * max_of(work, square_of(least_scale));
  }
};

/// How far conjugate gradients on the velocities that impulses cause have come.
struct CausedProgress {
  enum class End : std::int32_t { open, found, lost };
  static constexpr std::int64_t most_iterations = 1000;

  End end = End::open;
  std::int64_t iterations = 0;
  double square = 0;  ///< of the defect, in the norm of M^-1

  TETWARP_HD void begin(double first, double negligible) {
    square = first;
    decide(negligible);
  }
  /// @param step  length of the step along the direction; zero: rounding has made A or M^-1
  ///              indefinite, or there are no numbers
  /// @param next  square of the defect after it
  TETWARP_HD void add(double step, double next, double negligible) {
    if (step == 0) {
      end = End::lost;
      return;
    }
    const double gain = step * square;
    gains_[iterations++ % few] = gain;
    moved_ += gain;
    square = next;
    if (iterations == most_iterations) end = End::lost;
    decide(negligible);
    if (end == End::lost) return;
    double last = 0;
    for (const double own : gains_) last += own;
    if (iterations >= few && last <= least_gain * moved_) end = End::found;
  }

 private:
  static constexpr int few = 4;
  // The way to the solution, squared in the norm of A, is at least the sum of those of all steps.
  // Iterations end where the last few were at most this part of it.
  static constexpr double least_gain = 0.04;

  TETWARP_HD void decide(double negligible) {
    if (square <= negligible) end = End::found;
    if (!(square >= 0)) end = End::lost;  // rounding has made M^-1 indefinite, or no numbers
  }

  double moved_ = 0;        ///< square of the way so far, in the norm of A
  double gains_[few] = {};  ///< squares of the last steps
};

/// Goes on with at most `most` iterations.
/// @param exec        reads of its memory are free: host threads, or those of one launch
/// @param system      its x, in: an iterate or zero, out: v', or v' less what x began from; its r,
///                    in: the defect
/// @param begin, end  of its indices
/// @param negligible  ResidualCheckLimits::negligible()
/// @param progress    in and out
///
/// Determinism: same bits for any number of threads; sums are trees that depend only on the
/// indices.
template <class Exec, class System>
TETWARP_ANY_EXEC void find_caused(Exec& exec,
                                  const System& system,
                                  std::int64_t begin,
                                  std::int64_t end,
                                  double negligible,
                                  std::int64_t most,
                                  CausedProgress& progress) {
  GradientScalars scalars{};
  if (progress.iterations == 0) {
    gradient_start(exec, system, begin, end, &scalars.square);
    progress.begin(scalars.square.value[0], negligible);
  }
  scalars.square.value[0] = progress.square;
  const GradientIteration<System> iteration{system, begin, end, &scalars, &scalars.square};
  for (std::int64_t k = 0; k < most && progress.end == CausedProgress::End::open; ++k) {
    iteration.run(exec);
    progress.add(scalars.step, scalars.next.value[0], negligible);
  }
}

/// One index = one contact: its constants with a lower bound of its block of J A^-1 J^T.
///
/// All of A^-1 is at least M^-1 over the largest eigenvalue of M^-1 A: with omega D^-1 below 2, and
/// of a single block below omega; with factors at rest about 1.
struct LowerTouchOp {
  CompliantBodies of;
  TouchingRows touching;
  View<const ContactConstants<double>> constants;  ///< with blocks of J M^-1 J^T
  View<ContactConstants<double>> lower;            ///< out

  TETWARP_HD void operator()(std::int64_t contact) const {
    const std::int64_t first = touching.block_start[contact];
    const std::int64_t end = touching.block_start[contact + 1];
    double factor = 1;
    for (std::int64_t b = first; b < end; ++b) {
      const CompliantBody& own = of.of_row(touching.row[b]);
      if (own.frame < 0 && own.relaxation != 1) {
        factor = min_of(factor, end - first == 1 ? 1 / own.relaxation : 0.5);
      }
    }
    ContactConstants<double> own = constants[contact];
    for (double& entry : own.block) entry *= factor;
    own.tangent_metric *= factor;
    lower[contact] = own;
  }
};

/// One index = one contact: upper bound of its share in eta, lower bound of the same without
/// impulses, and work of its impulse.
struct CausedErrorOp {
  ResidualBoundOp bound;
  FreeResidualBoundOp free;

  TETWARP_HD PlainSums<3> operator()(std::int64_t contact) const {
    const ContactSums own = bound(contact);
    return {{own.eta, free(contact).eta, own.work}};
  }
};

/// @param sums  of CausedErrorOp
TETWARP_HD double caused_eta(const PlainSums<3>& sums, double least_scale) {
  if (sums.value[0] == 0) return 0;
  const double scale = sqrt(sums.value[1]) + sqrt(max_of(sums.value[2], 0.0));
  return sqrt(sums.value[0]) / max_of(scale, least_scale);
}

/// Vectors of an iterate, [3 contacts] each.
struct CheckedContacts {
  View<const double> impulse, velocity;  ///< r, u
  View<const double> free_velocity;      ///< u without impulses
  View<const double> zeros;
};

/// @param lower   of LowerTouchOp
/// @param caused  J v' + w, [3 contacts]
TETWARP_HD CausedErrorOp caused_error(const CheckedContacts& of,
                                      View<const ContactConstants<double>> lower,
                                      ContactSwitches switches,
                                      View<const double> caused) {
  const ContactResidualOp<double> natural{lower, switches, of.impulse, caused, of.free_velocity};
  const ContactResidualOp<double> alone{lower, switches, of.zeros, of.free_velocity,
                                        of.free_velocity};
  return {{natural, of.velocity}, {alone}};
}

}  // namespace tetwarp
