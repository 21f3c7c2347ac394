/// @file two_level_iteration.cuh
/// TwoLevelIteration: the two-level iteration over compliant bodies and their contacts on a device.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "host/base/stopwatch.hpp"
#include "host/simulate/step/cuda/residual_check_cuda.cuh"
#include "kernels/contact/anderson.hpp"
#include "kernels/contact/coupled_iteration.hpp"
#include "kernels/contact/proximal_step.hpp"
#include "kernels/exec/iteration_graph.cuh"

namespace tetwarp {

/// See TwoLevelSolver for what is iterated. Here all bodies are compliant ones, and instead of
/// sweeps, which visit contacts one after the other, accelerated proximal steps move all contacts
/// at once. The host reads the sums of an error once per outer iteration and per eight steps, and a
/// check of convergence once.
class TwoLevelIteration {
 public:
  /// @param exec                     whose streams are used
  /// @param node_count, rigid_count  of the model
  TwoLevelIteration(const CudaExec& exec, std::int64_t node_count, std::int64_t rigid_count)
      : exec_(exec, StageClocks::off),
        run_exec_(exec, StageClocks::off),
        check_(exec.number()),
        numbers_(node_count, rigid_count) {}

  /// @param rows    of the system, in memory of the device
  /// @param arrays  of the step
  /// @param points  of the surfaces, there
  CoupledOutcome solve(const SystemRows& rows,
                       const StepArrays<CudaExec>& arrays,
                       View<const SurfacePoint> points,
                       const CompliantLists& lists,
                       const TwoLevelStart& start,
                       RestFactors& factors,
                       const ContactOptions& options) {
    clock_ = {};
    lists_ = &lists;
    options_ = &options;
    switches_ = {options.law == FrictionLaw::pyramid, options.rule == AdhesionRule::restrictive};
    is_checked_ = lists.has_joined();
    if (is_checked_ && !check_.is_possible()) return {};
    numbers_.set(exec_, rows, arrays, points, lists, start, factors);
    resize();
    checked_ = 0;
    is_ended_ = false;
    CoupledOutcome outcome = solve_coupled<Mixer>(*this);
    outcome.is_result = outcome.converged || outcome.is_stopped;
    if (outcome.converged && checked_ > 0) outcome.residual = checked_;
    return outcome;
  }

  /// Impulses and velocities of contacts, [3 contacts] each, then velocities of rows, [rows][3].
  View<const double> results() const { return results_.view(); }
  View<const double> row_velocities() const { return View<const double>(velocity()); }
  View<const std::int32_t> model_block() const { return numbers_.model_block(); }

  // What solve_coupled() calls, which says what they do.
  using Next = CoupledControl::Next;
  CudaExec& exec() { return exec_; }
  View<double> now() { return velocity(); }
  View<double> image() { return image_.view(); }
  View<const double> weights() { return numbers_.weight(); }
  View<double> mixed() { return mixed_.view(); }
  bool has_elastic() const { return !lists_->model_body.empty(); }
  Next start(double damping, CoupledOutcome&) {
    run_.restart();
    numbers_.set_damping(exec_, damping);
    exec_.copy(label, numbers_.start_velocity(), velocity());
    for_each(contact_numbers_ / 3,
             TouchVelocityOp{rows(), numbers_.start_velocity(), free_velocity_.view()});
    step(numbers_.preload());
    least_error_ = CoupledError::least(exec_.load(&sums_.view().data->defect).value[0]);
    if (numbers_.change().size > 0) {
      for_each(row_numbers_, AddNumbersOp{numbers_.change(), velocity()});
    }
    exec_.copy(label, numbers_.start_impulse(), impulse());
    return Next::proceeds;
  }
  CoupledControl control(bool ends_early) {
    exec_.make_zeros(none_, contact_numbers_);  // zeros
    sum_error(const_view(none_), const_view(free_velocity_));
    const double share = is_checked_ ? CoupledControl::check_share : 1;
    return CoupledControl({.has_elastic = has_elastic(),
                           .ends_early = ends_early,
                           .tolerance = share * options_->tolerance,
                           .natural_alone = exec_.load(sums_.view().data).error.value[0],
                           .few_sweeps = ProximalState::steps_at_once,
                           .least_error = least_error_});
  }
  std::optional<CoupledError> find_error(const CoupledOutcome&) {
    step(impulse());
    for_each(node_start_.view().size / 3,
             NodeVelocityOp{bodies(), const_view(image_), node_start_.view()});
    for_each(contact_numbers_ / 3, TouchVelocityOp{rows(), velocity(), contact_velocity()});
    sum_error(impulse(), contact_velocity());
    const Sums sums = exec_.load(sums_.view().data);
    work_ = sums.error.value[1];
    CoupledError error = CoupledError::of(sums.defect.value[0], sums.error.value[0], work_);
    // Rounding may make inverses of very stiff bodies indefinite; then the host has to solve.
    if (sums.defect.value[0] < 0) error.total = std::numeric_limits<double>::quiet_NaN();
    return error;
  }
  static void keep(double) {}
  double excess(const CoupledOutcome& outcome) {
    if (!is_checked_) return 0;
    // A launch has no end but its own: a caller that may end the solve is asked between several.
    const std::int64_t most_at_once =
        options_->progress ? watched_iterations : CausedProgress::most_iterations;
    checked_ = check_.run(exec_, numbers_, switches_,
                          {options_->tolerance, least_error_ / options_->tolerance},
                          {velocity(),
                           defect_.view(),
                           moved_.view(),
                           {impulse(), contact_velocity(), free_velocity_.view(), none_.view()},
                           work_},
                          most_at_once, [&] { return !(is_ended_ = !goes_on(outcome)); });
    return checked_ / options_->tolerance;
  }
  Next limit(const CoupledOutcome& outcome) const {
    if (is_ended_) return Next::is_stopped;
    if (outcome.sweeps > most_of_solve) return Next::fails;
    return goes_on(outcome) ? Next::proceeds : Next::is_stopped;
  }
  void solve_contacts(double enough, CoupledOutcome& outcome) {
    exec_.copy(label, View<const double>(impulse()), stepped_.view());
    outcome.sweeps += step_contacts(enough);
    for_each_by_lanes(row_numbers_ / 3,
                      RowPushOp{bodies(), rows(), impulse(), const_view(stepped_), defect_.view()});
    move(const_view(image_));
  }
  void take_image() { exec_.copy(label, const_view(image_), velocity()); }

 private:
  using Mixer = AndersonMixer<CudaExec, double>;
  using Vector = DeviceVector<double>;
  /// Sums that the host reads together.
  struct Sums {
    PlainSums<1> defect;
    PlainSums<2> error;
  };
  // Proximal steps, of an outer iteration and of a solve: bounds for what does not converge. The
  // scene `candy` takes 121 a time step.
  static constexpr std::int64_t most_steps = 1000;
  static constexpr std::int64_t most_of_solve = 20000;
  // Of conjugate gradients, about a millisecond.
  static constexpr std::int64_t watched_iterations = 100;
  static constexpr int most_growths = 10;  ///< of the majorants, of an outer iteration
  static constexpr const char* label = "body/contact";

  bool goes_on(const CoupledOutcome& outcome) const {
    return !options_->progress || options_->progress({clock_.seconds(), outcome.sweeps, 0});
  }
  View<double> part(std::int64_t first, std::int64_t size) const {
    return {results_data_ + first, size};
  }
  View<double> impulse() const { return part(0, contact_numbers_); }
  View<double> contact_velocity() const { return part(contact_numbers_, contact_numbers_); }
  View<double> velocity() const { return part(2 * contact_numbers_, row_numbers_); }
  const CompliantBodies& bodies() const { return numbers_.touching().bodies; }
  const TouchingRows& rows() const { return numbers_.touching().rows; }

  template <class Op>
  void for_each(std::int64_t count, const Op& op) {
    exec_.for_each(label, count, op);
  }
  template <class Op>
  void for_each_by_lanes(std::int64_t count, const Op& op) {
    exec_.for_each_by_lanes(label, count, op);
  }

  void resize() {
    contact_numbers_ = 3 * (rows().block_start.size - 1);
    row_numbers_ = 3 * lists_->row_count();
    const std::int64_t nodes = 3 * bodies().row_of_node.size;
    results_.resize(2 * contact_numbers_ + row_numbers_);
    results_data_ = results_.view().data;
    for (Vector* v : {&free_velocity_, &none_, &stepped_, &ahead_}) {
      v->resize(contact_numbers_);
    }
    for (Vector* v : {&image_, &defect_, &moved_}) v->resize(row_numbers_);
    for (Vector* v : {&node_start_, &node_velocity_, &push_}) v->resize(nodes);
    past_.resize(2 * contact_numbers_);
    mixed_.resize(Mixer::columns * row_numbers_);
    terms_.resize(contact_numbers_ / 3);
    sums_.resize(1);
    state_.resize(1);
    if (is_checked_) check_.resize(contact_numbers_, row_numbers_);
  }

  /// image = velocity + M^-1 d, d = b + J^T (r - preload) - A velocity; sums d . M^-1 d.
  void step(View<const double> r) {
    for_each_by_lanes(row_numbers_ / 3, numbers_.defect(velocity(), r, defect_.view()));
    move(velocity());
    exec_.sum_to(label, 0, row_numbers_, DefectSquareOp{const_view(defect_), const_view(moved_)},
                 &sums_.view().data->defect);
  }
  /// image = from + M^-1 of what is in `defect_`.
  void move(View<const double> from) {
    for_each_by_lanes(row_numbers_ / 3, ComplianceOp{bodies(), const_view(defect_), moved_.view()});
    for_each(row_numbers_ / 3, RowMoveOp{bodies(), const_view(moved_), from, image_.view()});
  }
  void sum_error(View<const double> r, View<const double> u) {
    exec_.sum_to(label, 0, contact_numbers_ / 3,
                 TouchErrorOp{numbers_.constants(), switches_, r, u, const_view(free_velocity_)},
                 &sums_.view().data->error);
  }
  /// Steps until the laws were off by at most `enough` before the last one. @returns the steps
  std::int64_t step_contacts(double enough) {
    constexpr int count = ProximalState::steps_at_once;
    ProximalState* const state = state_.view().data;
    start_steps(state);
    int growths = 0;
    for (std::int64_t steps = count;; steps += count) {
      make_run(state);
      const ProximalState::Sums sums = exec_.load(&state->sums);
      const double laws = CoupledError::of(0, sums.value[0], 0).laws;
      if (laws <= enough || steps >= most_steps) return steps;
      if (growths < most_growths && ProximalState::has_missed(sums)) {
        ++growths;
        numbers_.grow_majorants(exec_);
        start_steps(state);
      } else {
        exec_.once(label, ProximalDecideOp{state});
      }
    }
  }
  /// Eight steps and their sums.
  void make_run(ProximalState* state) {
    run_.launch(exec_.stream(), [&] {
      for (int step = 0; step < ProximalState::steps_at_once; ++step) {
        step_contacts_once(state, step);
      }
      run_exec_.sum_to(label, 0, terms_.view().size, ReadySums<ProximalState::Sums>{terms_.view()},
                       &state->sums);
    });
  }
  void start_steps(ProximalState* state) {
    exec_.once(label, ProximalStartOp{state});
    exec_.copy(label, const_view(stepped_), impulse());
    exec_.copy(label, const_view(stepped_), ahead_.view());
    exec_.copy(label, const_view(node_start_), node_velocity_.view());
  }
  void step_contacts_once(const ProximalState* state, int step) {
    const TouchingNodes& touching = numbers_.touching();
    for_each_by_lanes(contact_numbers_ / 3,
                      ProximalStepOp{touching, numbers_.constants(), numbers_.majorant(), switches_,
                                     const_view(node_velocity_), state, step, ahead_.view(),
                                     impulse(), past_.view(), terms_.view()});
    const std::int64_t nodes = push_.view().size / 3;
    for_each_by_lanes(nodes,
                      NodePushOp{touching, const_view(ahead_), const_view(stepped_), push_.view()});
    for_each_by_lanes(nodes, NodeMoveOp{bodies(), const_view(push_), const_view(node_start_),
                                        node_velocity_.view()});
  }

  CudaExec exec_;
  CudaExec run_exec_;  ///< of recorded runs: its sums stay where they are
  ResidualCheckCuda check_;
  TwoLevelNumbers numbers_;
  const CompliantLists* lists_ = nullptr;    ///< of the present solve
  const ContactOptions* options_ = nullptr;  ///< of the present solve
  ContactSwitches switches_;
  Stopwatch clock_;
  std::int64_t contact_numbers_ = 0, row_numbers_ = 0;  ///< 3 per contact, per row
  double least_error_ = 0;                              ///< of the velocities without contact
  double work_ = 0;                                     ///< of the last impulses
  bool is_checked_ = false;  ///< whether its own errors are no measure of convergence
  double checked_ = 0;       ///< eta by the last check
  bool is_ended_ = false;    ///< by the caller, within a check
  Vector results_;
  double* results_data_ = nullptr;
  Vector free_velocity_, none_, stepped_, ahead_;  ///< [3 contacts]
  Vector image_, defect_, moved_;                  ///< [rows][3]; the last two in frames
  Vector node_start_, node_velocity_, push_;  ///< [nodes][3] in frames; node_start_: with stepped_
  Vector past_;                               ///< [contacts][6], of ProximalStepOp
  DeviceVector<ProximalState::Sums> terms_;   ///< [contacts]
  DeviceVector<ProximalState> state_;
  IterationGraph run_;  ///< of the present numbers
  Vector mixed_;        ///< of the mixer
  DeviceVector<Sums> sums_;
};

}  // namespace tetwarp
