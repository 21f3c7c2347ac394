/// @file coupled_iteration.hpp
/// The iteration over bodies that A couples and their contacts: of the contact solver and of
/// simulations, on any executor.
///
/// With a matrix M^-1 by which bodies give way, close to A^-1, a step from velocities v and
/// impulses r is
///
///     v_f = v + M^-1 (b + J^T r - A v)
///     r', which solves the laws of the contacts in  u = J v_f + J M^-1 J^T (r' - r) + w
///     v' = v_f + M^-1 J^T (r' - r),  accelerated over steps (Anderson)
///
/// so that its fixed points solve A v = b + J^T r with the laws, whatever M is. How bodies give
/// way, how r' is found and where J is belong to the problem that is iterated.
#pragma once
#include <cstdint>
#include <optional>

#include "kernels/contact/coupled_control.hpp"

namespace tetwarp {

/// @tparam Accelerator  see contact_accelerators.hpp; of v
/// @tparam Problem      what is iterated:
///
///     exec()                         executor of the accelerator
///     weights(), mixed()             its metric and work vectors
///     now(), image()                 v and v'
///     find_error(outcome)            makes v_f the image; the error of v and r, or none: not read
///                                    before this step
///     keep(residual)                 v and r are the best so far
///     excess(outcome)                see CoupledControl::next()
///     limit(outcome)                 fails or is_stopped, to end before a step; else proceeds
///     solve_contacts(enough, outcome)  makes r' the impulses and v' the image; counts sweeps
///     take_image()                   v becomes the image
///
/// @param most     outer iterations, those of `outcome` included
/// @param outcome  in and out: counts, residual
template <class Accelerator, class Problem>
CoupledControl::Next iterate_coupled(Problem& problem,
                                     CoupledControl control,
                                     std::int64_t most,
                                     CoupledOutcome& outcome) {
  using Next = CoupledControl::Next;
  Accelerator accelerator(problem.exec(), problem.weights(), problem.mixed());
  while (outcome.outer_iterations < most) {
    if (const std::optional<CoupledError> error = problem.find_error(outcome)) {
      const Next next =
          control.next(*error, outcome.sweeps, [&] { return problem.excess(outcome); });
      outcome.residual = control.residual();
      if (control.is_best()) problem.keep(control.residual());
      // The closer measure also has no answer where the caller ends it.
      if (next == Next::fails && problem.limit(outcome) == Next::is_stopped)
        return Next::is_stopped;
      if (next != Next::proceeds) return next;
      if (control.has_grown()) accelerator.forget();
    }
    const Next limit = problem.limit(outcome);
    if (limit != Next::proceeds) return limit;
    problem.solve_contacts(control.enough(), outcome);
    ++outcome.outer_iterations;
    if (control.mixes()) {
      accelerator.observe(problem.now(), problem.image());
      accelerator.advance(problem.now(), problem.image());
    } else {
      accelerator.forget();
    }
    problem.take_image();
  }
  return Next::fails;
}

/// Iterates with M^-1, and where that diverges with half of it, and so on.
/// @tparam Problem  as above, and:
///
///     start(damping, outcome)  sets M^-1, v and r to start from; returns proceeds, or how another
///                              method has ended
///     has_elastic()            whether M^-1 has a factor to be damped
///     control(ends_early)      -> CoupledControl
template <class Accelerator, class Problem>
CoupledOutcome solve_coupled(Problem& problem) {
  using Next = CoupledControl::Next;
  CoupledOutcome outcome;
  Next end = Next::diverges;
  for (double damping = 1; end == Next::diverges; damping /= 2) {
    end = problem.start(damping, outcome);
    if (end != Next::proceeds) break;
    const bool can_be_damped = problem.has_elastic() && damping > CoupledControl::least_damping;
    end = iterate_coupled<Accelerator>(problem, problem.control(can_be_damped),
                                       CoupledControl::most_iterations, outcome);
  }
  outcome.is_stopped = end == Next::is_stopped;
  outcome.converged = end == Next::converges;
  return outcome;
}

}  // namespace tetwarp
