/// @file contact_methods.hpp
/// Methods for one island whose blocks A does not couple: sweeps, plain or accelerated.
#pragma once
#include <cstdint>

#include <tetwarp/choices.hpp>

#include "kernels/contact/anderson.hpp"
#include "kernels/contact/contact_accelerators.hpp"
#include "kernels/contact/contact_pipeline.hpp"
#include "kernels/contact/convergence_test.hpp"

namespace tetwarp {

/// One index = one contact: the diagonal metric of impulse differences, 1 / rho with the weights
/// rho of eta.
template <class T>
struct ImpulseWeightsOp {
  View<const ContactConstants<T>> constants;
  View<double> weights;

  TETWARP_HD void operator()(std::int64_t c) const {
    const ContactConstants<T>& contact = constants[c];
    const double normal = contact.block[0], tangent = contact.tangent_metric;
    weights[3 * c] = normal / (1 + normal * contact.normal_spring);
    weights[3 * c + 1] = weights[3 * c + 2] = tangent / (1 + tangent * contact.tangent_spring);
  }
};

/// Work vectors of the methods; their contents are not kept from island to island.
template <class T>
struct MethodWork {
  static constexpr int columns = AndersonMixer<int, T>::columns;

  View<double> weights;  ///< [3 slots]
  View<T> before, best;  ///< impulses before the last step; the best so far; [3 slots]
  View<T> mixed;         ///< [columns][3 slots], island after island

  /// The views of one island.
  TETWARP_HD MethodWork of(const ContactIsland& island) const {
    const std::int64_t first = 3 * island.slot_begin, size = 3 * island.contact_count();
    return {{weights.data + first, size},
            {before.data + first, size},
            {best.data + first, size},
            {mixed.data + columns * first, columns * size}};
  }
};

/// The methods of one island. Each continues from the current impulses and returns why it stopped;
/// restore_best() restores the iterate with the smallest residual.
template <class Exec, class T, class Log>
class ContactMethods {
 public:
  /// @param work  views of the whole problem
  TETWARP_ANY_EXEC ContactMethods(ContactPipeline<Exec, T>& pipeline,
                                  ConvergenceTest<Log>& convergence,
                                  const MethodWork<T>& work)
      : pipeline_(pipeline), convergence_(convergence), work_(work.of(pipeline.island())) {
    exec().for_each("contact/sweep", pipeline_.constants().size,
                    ImpulseWeightsOp<T>{pipeline_.constants(), work_.weights});
    exec().copy("contact/sweep", View<const T>(pipeline_.impulse()), work_.best);
  }

  /// Measures the residual of the current impulses.
  /// @return  whether they are within the tolerance, or the budget of sweeps is used up
  TETWARP_ANY_EXEC bool is_done_at_start() {
    pipeline_.follow_impulses();
    return measure(0);
  }

  TETWARP_ANY_EXEC StopReason gauss_seidel(const Patience& patience,
                                           const FrozenContacts<T>& frozen) {
    return iterate<PlainSteps<Exec, T>>(patience, frozen);
  }
  TETWARP_ANY_EXEC StopReason anderson(const Patience& patience) {
    return iterate<AndersonMixer<Exec, T>>(patience, {});
  }
  TETWARP_ANY_EXEC StopReason conjugate_directions(const Patience& patience) {
    return iterate<ConjugateDirection<Exec, T>>(patience, {});
  }

  /// Runs a method. `automatic` and `newton`, which starts from the result, use Anderson
  /// acceleration and, if it stalls, conjugate directions from the best iterate.
  /// @param frozen  contacts that plain sweeps may skip
  /// @return  whether it switched to conjugate directions
  TETWARP_ANY_EXEC bool run(ContactMethod method, const FrozenContacts<T>& frozen) {
    switch (method) {
      case ContactMethod::gauss_seidel:
        gauss_seidel({}, frozen);
        return false;
      case ContactMethod::nonlinear_cg:
        conjugate_directions({});
        return false;
      case ContactMethod::anderson:
        anderson({});
        return false;
      case ContactMethod::automatic:
      case ContactMethod::newton:
        break;
    }
    if (anderson({52, 4, 0.6, 10}) != StopReason::stalled) return false;
    restore_best();
    conjugate_directions({48, 1, 0.5});
    return true;
  }

  /// Makes the best impulses the current ones.
  TETWARP_ANY_EXEC void restore_best() {
    exec().copy("contact/sweep", View<const T>(work_.best), pipeline_.impulse());
    pipeline_.follow_impulses();
  }

 private:
  TETWARP_HD Exec& exec() const { return pipeline_.exec(); }

  template <class Accelerator>
  TETWARP_ANY_EXEC StopReason iterate(const Patience& patience, FrozenContacts<T> frozen) {
    Accelerator accelerator(exec(), work_.weights, work_.mixed);
    convergence_.start_method(patience);
    const View<T> x = pipeline_.impulse();
    const View<const T> before = work_.before;
    while (!convergence_.is_exhausted()) {
      exec().copy("contact/mix", View<const T>(x), work_.before);
      frozen.all_active = frozen.unchanged_visits.size == 0 ||
                          convergence_.sweeps() % FrozenContacts<T>::revisit_interval == 0;
      pipeline_.sweep(frozen);
      convergence_.count_sweep();
      accelerator.observe(before, x);
      if (is_sync_point()) {
        const double defect = accelerator.defect();
        if (convergence_.is_due(defect) && measure(defect)) break;
      }
      if (accelerator.advance(before, x)) pipeline_.follow_impulses();
    }
    return convergence_.reason();
  }

  /// Whether the host reads results of the executor after this sweep.
  TETWARP_ANY_EXEC bool is_sync_point() const {
    return exec().is_sync_point(convergence_.sweeps()) || convergence_.is_exhausted();
  }

  /// @return  whether to stop
  TETWARP_ANY_EXEC bool measure(double defect) {
    bool is_best = false;
    const bool is_done = convergence_.record(pipeline_.measure(), defect, is_best);
    if (is_best) exec().copy("contact/sweep", View<const T>(pipeline_.impulse()), work_.best);
    return is_done;
  }

  ContactPipeline<Exec, T>& pipeline_;
  ConvergenceTest<Log>& convergence_;
  MethodWork<T> work_;
};

/// Why and when the solve of an island ended.
struct IslandEnd {
  StopReason reason = StopReason::exhausted;
  std::int64_t sweeps = 0;    ///< those of earlier solves included
  bool has_switched = false;  ///< from accelerated sweeps to conjugate directions
  double best_excess = 0;     ///< error over allowed error of the best impulses
};

/// Method and budget of every island.
struct MethodPlan {
  ContactMethod method = ContactMethod::automatic;
  double freeze_share = 0;  ///< FrozenContacts::share, if the state has counters
  std::int64_t sweep_budget = 0;
  bool leaves_best = true;  ///< else the last impulses, the best in MethodWork::best
};

/// Solves one island from the current impulses and leaves the best ones, or the last.
/// @param sweeps_done  by earlier solves of the island
/// @param work         views of the whole problem
/// @param log          receives every measured residual by note(ContactEvent)
template <class Exec, class T, class Log>
TETWARP_ANY_EXEC IslandEnd solve_island(ContactPipeline<Exec, T>& pipeline,
                                        const StopCriterion& criterion,
                                        const MethodPlan& plan,
                                        std::int64_t sweeps_done,
                                        const MethodWork<T>& work,
                                        Log& log) {
  ConvergenceTest<Log> convergence(criterion, sweeps_done, plan.sweep_budget, log);
  ContactMethods<Exec, T, Log> methods(pipeline, convergence, work);
  bool has_switched = false;
  if (!methods.is_done_at_start()) {
    const ContactState<T>& state = pipeline.state();
    has_switched = methods.run(plan.method, {state.unchanged_visits, state.skipped_visits, true,
                                             static_cast<T>(plan.freeze_share)});
    if (plan.leaves_best) methods.restore_best();
  }
  return {convergence.reason(), convergence.sweeps(), has_switched, convergence.best_excess()};
}

/// Residual of an island and the scale of its free velocities.
struct IslandSums {
  ContactSums sums;
  double free_square = 0;  ///< |q|^2
};

/// Measures the current impulses of an island and sets the body velocities that follow from them.
template <class Exec, class T>
TETWARP_ANY_EXEC IslandSums measure_island(ContactPipeline<Exec, T> pipeline) {
  pipeline.follow_impulses();
  IslandSums result;
  result.sums = pipeline.measure(true);
  result.free_square = pipeline.free_square();
  return result;
}

}  // namespace tetwarp
