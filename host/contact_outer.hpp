/// @file contact_outer.hpp
/// Contacts of bodies that A couples, by an outer block-Jacobi iteration around sweeps.
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/contact_accelerators.hpp"
#include "host/contact_coupled.hpp"

namespace tetwarp {

/// Sweeps of one outer step. One is enough where no two contacts share a body: there is one color.
inline int sweeps_per_step(const ContactOptions& options, const ContactIsland& island) {
  return island.color_end - island.color_begin > 2 ? options.inner_sweeps : 1;
}

/// With D the diagonal blocks of A and q = J v_f + w, one outer step is
///
///     v_f = v - omega D^-1 (A v - b)
///     sweeps solve the contacts in  u = omega J D^-1 J^T r + q
///     v = v_f + omega D^-1 J^T r
///
/// Proximal gradients in the metric D / omega: it converges where omega times the largest
/// eigenvalue of D^-1 A is below 2. That eigenvalue is at most the number of nodes of an element,
/// so that 0.5 suits tetrahedra. Where A couples nothing and omega is 1, one step is exact.
/// Source: Otaduy et al. 2009 (iterative constraint anticipation); relaxation and acceleration
/// (Anderson, or nonlinear conjugate gradients, on v) are ours.
///
/// In float32 it ends where rounding does not let it come closer, too; whoever judges does so in
/// float64.
template <class Exec, class T = double>
class OuterIteration {
 public:
  /// @param judge  has been started
  OuterIteration(Exec& exec,
                 const ContactOptions& options,
                 const ContactStructure& structure,
                 const ContactSystem<T>& system,
                 const ContactIsland& island,
                 CoupledJudge<Exec>& judge)
      : exec_(exec),
        options_(options),
        pipeline_(exec, structure, system, island, switches_of(options), state_),
        judge_(judge),
        inner_sweeps_(sweeps_per_step(options, island)),
        weights_(diagonal_of(structure, system, island)),
        before_(system.load.size()) {}

  /// Goes on until judged done, out of budget, or far off.
  /// @param most           outer iterations
  /// @param impulse        to start from, [3 slots]
  /// @param body_velocity  to start from, [dofs]
  void solve(std::int64_t most,
             const std::vector<double>& impulse,
             const std::vector<double>& body_velocity,
             IslandOutcome& outcome) {
    state_.impulse.assign(impulse.begin(), impulse.end());
    state_.body_velocity.assign(body_velocity.begin(), body_velocity.end());
    state_.defect.resize(state_.body_velocity.size());
    iterate(most, outcome);
    outcome.contact_updates = outcome.sweeps * pipeline_.island().contact_count();
  }

  bool is_lost() const { return is_lost_; }
  std::vector<double> impulse() const { return {state_.impulse.begin(), state_.impulse.end()}; }
  std::vector<double> body_velocity() const {
    return {state_.body_velocity.begin(), state_.body_velocity.end()};
  }

 private:
  void iterate(std::int64_t most, IslandOutcome& outcome) {
    switch (options_.method) {
      case ContactMethod::gauss_seidel:
        outcome.methods = {"outer_jacobi"};
        return iterate<PlainSteps<Exec, T>>(most, outcome);
      case ContactMethod::nonlinear_cg:
        outcome.methods = {"outer_nonlinear_cg"};
        return iterate<ConjugateDirection<Exec, T>>(most, outcome);
      default:
        outcome.methods = {"outer_anderson"};
        return iterate<AndersonMixer<Exec, T>>(most, outcome);
    }
  }

  template <class Accelerator>
  void iterate(std::int64_t most, IslandOutcome& outcome) {
    Accelerator accelerator(exec_, weights_);
    const std::int64_t first = outcome.outer_iterations + 1;
    double start = size_of_velocity();
    while (outcome.outer_iterations < most) {
      std::swap(before_, state_.body_velocity);
      pipeline_.step_bodies(before_, static_cast<T>(options_.relaxation));
      for (int sweep = 0; sweep < inner_sweeps_; ++sweep) pipeline_.sweep({});
      outcome.sweeps += inner_sweeps_;
      ++outcome.outer_iterations;
      const View<const T> before = {before_.data() + pipeline_.island().dof_begin,
                                    pipeline_.body_velocity().size};
      const double defect = accelerator.observe(before, pipeline_.body_velocity());
      if (outcome.outer_iterations == first) {
        start += defect;
        aim_ = options_.tolerance * start;
      }
      is_lost_ = !(defect <= divergence * start);
      if (is_lost_) return;
      const bool is_last = outcome.outer_iterations == most;
      const bool is_due = is_last || defect <= aim_ || outcome.outer_iterations >= next_;
      if (is_due && judge(defect, is_last, outcome) <= 1) return;
      if (std::is_same_v<T, float> && is_as_close_as_float32(defect / start, outcome)) return;
      accelerator.advance(before, pipeline_.body_velocity(), defect);
    }
  }

  double size_of_velocity() {
    const std::vector<T> rest(weights_.size(), T(0));
    const View<const T> v = pipeline_.body_velocity();
    return defect_of(exec_, weights_, view_of(rest), v);
  }

  /// Whether rounding is, or may be, what keeps the defect from falling.
  bool is_as_close_as_float32(double defect, const IslandOutcome& outcome) {
    constexpr double rounding = 1e-6;
    constexpr std::int64_t patience = 100;
    if (defect < 0.5 * lowest_) {
      lowest_ = defect;
      lowest_at_ = outcome.outer_iterations;
    }
    return defect <= rounding || outcome.outer_iterations - lowest_at_ > patience;
  }

  /// Judging costs as much as 5 to 30 steps: it is done when the defect of the iteration has
  /// dropped as far as the last judgement asked for, at first to the tolerance, and now and then.
  double judge(double defect, bool is_last, IslandOutcome& outcome) {
    const double excess = judge_.judge(impulse(), body_velocity(), is_last, outcome);
    aim_ = 0.9 * defect / excess;
    next_ = 2 * std::max(outcome.outer_iterations, first_check);
    return excess;
  }

  /// The diagonal of A: nearly the metric of the iteration.
  static std::vector<double> diagonal_of(const ContactStructure& structure,
                                         const ContactSystem<T>& system,
                                         const ContactIsland& island) {
    std::vector<double> diagonal;
    for (std::int64_t b = island.block_begin; b < island.block_end; ++b) {
      const auto block = static_cast<std::size_t>(b);
      const std::int64_t size = structure.dof_start[block + 1] - structure.dof_start[block];
      for (std::int64_t k = 0; k < size; ++k) {
        diagonal.push_back(system.system[static_cast<std::size_t>(structure.diagonal_value[block] +
                                                                  k * (size + 1))]);
      }
    }
    return diagonal;
  }

  static constexpr std::int64_t first_check = 32;
  static constexpr double divergence = 1e8;  ///< of the velocities: nothing comes back from there

  Exec& exec_;
  const ContactOptions& options_;
  ContactState<T> state_;
  ContactPipeline<Exec, T> pipeline_;
  CoupledJudge<Exec>& judge_;
  int inner_sweeps_;
  std::vector<double> weights_;
  std::vector<T> before_;  ///< v of the step before, [dofs]
  double aim_ = 0;
  std::int64_t next_ = 2 * first_check;
  double lowest_ = std::numeric_limits<double>::infinity();
  std::int64_t lowest_at_ = 0;
  bool is_lost_ = false;
};

}  // namespace tetwarp
