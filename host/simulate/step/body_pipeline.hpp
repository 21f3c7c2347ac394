/// @file body_pipeline.hpp
/// BodyPipeline: one step of bodies as a list of stages, on any executor.
#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/simulate/step/body_arrays.hpp"
#include "host/simulate/step/island_gradients.hpp"
#include "host/simulate/step/solve_arrays.hpp"
#include "host/simulate/step/step_clock.hpp"
#include "kernels/base/host_copy.hpp"
#include "kernels/base/stage_times.hpp"
#include "kernels/body/flag_count.hpp"
#include "kernels/body/node_moved.hpp"
#include "kernels/body/rigid_midpoint.hpp"

namespace tetwarp {

/// Backward Euler: (M + dt C + dt^2 K) v = M v0 + dt F, then x += dt v. See stepper.hpp for what
/// its functions do. A step allocates no memory once system() and move() have been called.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec, class T>
class BodyPipeline {
 public:
  /// @param exec, islands, model  kept by the caller
  BodyPipeline(Exec& exec,
               IslandGradients<Exec>& islands,
               const Model& model,
               const StepperOptions& options)
      : BodyPipeline(exec, islands, model, options, make_system_pattern(model)) {}

  void set_state(const ModelState& state) {
    check("positions", count_of(state.position), model_.node_count + model_.rigid_count);
    check("velocities", count_of(state.velocity), model_.block_count());
    check("rotations", count_of(state.rotation), model_.rigid_count);
    check("angular momenta", count_of(state.angular_momentum), model_.rigid_count);
    const double* const position = numbers_of(state.position).data;
    const std::int64_t nodes = 3 * std::int64_t{model_.node_count};
    exec_.put(position, nodes, now_.position);
    exec_.put(position + nodes, 3 * std::int64_t{model_.rigid_count}, now_.center);
    put(numbers_of(state.rotation), now_.rotation);
    put(numbers_of(state.velocity), now_.velocity);
    put(numbers_of(state.angular_momentum), now_.angular_momentum);
    exec_.make_zeros(now_.previous, nodes);
    forget_steps();
  }
  /// Makes the next step compute all rotations and blocks anew.
  void forget_steps() {
    exec_.for_each(
        forces_label, exec_.view(now_.previous).size,
        FillNumbersOp{std::numeric_limits<double>::quiet_NaN(), exec_.view(now_.previous)});
    assembled_time_step_ = 0;
  }

  void get_state(ModelState& state) const {
    state.rotation.resize(static_cast<std::size_t>(model_.rigid_count));
    state.position.resize(static_cast<std::size_t>(model_.node_count) + state.rotation.size());
    state.angular_momentum.resize(state.rotation.size());
    state.velocity.resize(static_cast<std::size_t>(model_.block_count()));
    exec_.get_all({to_host(now_.position, state.position.data()),
                   to_host(now_.center, state.position.data() + model_.node_count),
                   to_host(now_.rotation, state.rotation.data()),
                   to_host(now_.angular_momentum, state.angular_momentum.data()),
                   to_host(now_.velocity, state.velocity.data())});
  }

  StepOutcome solve(const StepInput& input) {
    StepOutcome outcome;
    system_.forget();
    exec_.times().clear();
    upload(input);
    forces(input);
    assemble(input);
    solve(outcome);
    count_skipped(outcome);
    outcome.seconds = seconds();
    return outcome;
  }

  SystemRows host_rows() { return system_.rows(model_, pattern_.rows()); }  ///< on the host
  StepSystem system() {
    return system_.get(exec_, model_, pattern_.rows(), const_view(now_.values),
                       const_view(now_.load), const_view(now_.x));
  }
  void get_velocities(std::vector<Point3>& velocity) const { get_blocks(now_.velocity, velocity); }
  void set_velocities(const std::vector<Point3>& velocity) {
    check("velocities", count_of(velocity), model_.block_count());
    put(numbers_of(velocity), now_.velocity);
  }

  double move(double time_step, std::span<const double> fraction) {
    exec_.times().clear();
    fractions_of(model_, fraction, fraction_);
    put(numbers_of(fraction_), now_.fraction);
    update(time_step);
    return seconds().total;
  }

  std::vector<Point3> support_impulses() const {
    std::vector<Point3> impulses;
    get_blocks(now_.support, impulses);
    return impulses;
  }
  const double* position_of(std::int32_t node) const {
    return exec_.view(now_.position).data + 3 * std::int64_t{node};
  }
  const ConstantArrays<Exec>& constants() const { return constants_; }
  StepArrays<Exec>& arrays() { return now_; }
  const SystemRows& rows() const { return pattern_.rows(); }  ///< in memory of the executor

 private:
  static constexpr const char* forces_label = "body/forces";
  static constexpr const char* assembly_label = "body/assembly";
  static constexpr const char* linear_label = gradient_label();
  static constexpr const char* update_label = "body/update";
  static constexpr const char* count_label = "body/count";

  BodyPipeline(Exec& exec,
               IslandGradients<Exec>& islands,
               const Model& model,
               const StepperOptions& options,
               const SystemPattern& pattern)
      : exec_(exec),
        islands_(islands),
        model_(model),
        options_(options),
        pattern_(exec, pattern),
        constants_(exec, model),
        now_(exec, model, pattern_.rows()),
        solve_(exec, pattern_.rows(), exec.view(now_.values).size, model.rigid_count) {
    islands_.set_islands(pattern.island_start);
    exec_.resize(counts_, 2);
    set_state(model.start);
  }

  static void check(const char* what, std::int64_t size, std::int64_t expected) {
    if (size != expected) {
      throw std::invalid_argument("simulation: expected " + std::to_string(expected) + " " + what +
                                  ", got " + std::to_string(size));
    }
  }
  template <class Array>
  void put(View<const double> host, Array& own) {
    exec_.put(host.data, host.size, own);
  }
  template <class Array>
  void renew(View<const double> host, Array& own) {
    exec_.renew(host.data, host.size, own);
  }
  template <class Array, class Numbers>
  HostCopy to_host(const Array& own, Numbers* to) const {
    return {exec_.view(own), reinterpret_cast<double*>(to)};
  }
  template <class Array>
  void get_blocks(const Array& own, std::vector<Point3>& to) const {
    to.resize(static_cast<std::size_t>(model_.block_count()));
    exec_.get_all({to_host(own, to.data())});
  }

  void upload(const StepInput& input) {
    const std::int64_t springs = count_of(model_.springs.a);
    check("prescribed velocities", count_of(input.prescribed_velocity), model_.block_count());
    check("forces of loads", count_of(input.block_force), model_.block_count());
    check("anchors", count_of(input.anchor), springs);
    check("velocities of anchors", count_of(input.anchor_velocity), springs);
    check("states of springs", count_of(input.is_active), springs);
    renew(numbers_of(input.prescribed_velocity), now_.prescribed);
    renew(numbers_of(input.block_force), now_.force);
    const std::int64_t guesses = count_of(input.guess), flags = count_of(input.is_asleep);
    if (guesses > 0) check("velocities to start from", guesses, model_.block_count());
    renew(numbers_of(input.guess), now_.guess);
    renew(numbers_of(input.anchor), now_.anchor);
    renew(numbers_of(input.anchor_velocity), now_.anchor_velocity);
    exec_.renew(input.is_active.data(), springs, now_.is_active);
    if (flags > 0) check("flags of sleep", flags, model_.block_count());
    exec_.renew(input.is_asleep.data(), flags, now_.is_asleep);
  }

  void forces(const StepInput& input) {
    const auto position = const_view(now_.position);
    exec_.for_each(forces_label, model_.node_count,
                   NodeMovedOp{position, exec_.view(now_.previous), exec_.view(now_.has_moved)});
    const auto moved = const_view(now_.has_moved);
    tet_forces(exec_, forces_label,
               TetForceOp{constants_.tets, position, moved, options_.skip.rotations,
                          exec_.view(now_.turned), exec_.view(now_.tet_force),
                          exec_.view(now_.tet_has_turned), exec_.view(now_.tet_is_skipped)});
    exec_.for_each(forces_label, count_of(model_.edges.nodes),
                   EdgeSpringOp{constants_.edge_nodes, constants_.edge_stiffness,
                                constants_.edge_rest, position, moved, exec_.view(now_.edge_pull),
                                exec_.view(now_.edge_has_turned)});
    exec_.for_each(
        forces_label, count_of(model_.springs.a),
        PointSpringOp{constants_.springs, position,
                      RigidPlaces{const_view(now_.center), const_view(now_.rotation)},
                      const_view(now_.anchor), const_view(now_.anchor_velocity),
                      const_view(now_.is_active), input.time_step, exec_.view(now_.spring_pull)});
    exec_.for_each(forces_label, model_.rigid_count,
                   RigidMidpointOp{constants_.moments, const_view(now_.rotation),
                                   const_view(now_.angular_momentum), input.time_step,
                                   exec_.view(now_.inertia)});
  }

  void assemble(const StepInput& input) {
    const SystemRows& rows = pattern_.rows();
    const double dt = input.time_step;
    const ElementResults from = {
        const_view(now_.turned),    const_view(now_.tet_force),  const_view(now_.tet_has_turned),
        const_view(now_.edge_pull), constants_.edge_gamma,       const_view(now_.edge_has_turned),
        constants_.springs,         const_view(now_.spring_pull)};
    RigidConstants rigid = constants_.rigid;
    rigid.inertia = const_view(now_.inertia);
    const bool skips = options_.skip.blocks && dt == assembled_time_step_;
    block_assemble(exec_, assembly_label,
                   BlockAssembleOp{rows, from, constants_.scalars, rigid, dt, skips,
                                   exec_.view(now_.values), exec_.view(now_.block_is_skipped)});
    assembled_time_step_ = dt;
    const LoadInput load = {{input.gravity[0], input.gravity[1], input.gravity[2]},
                            const_view(now_.force),
                            const_view(now_.position),
                            const_view(now_.velocity),
                            const_view(now_.angular_momentum),
                            constants_.node_mass,
                            model_.node_count,
                            const_view(now_.is_asleep)};
    exec_.for_each(
        assembly_label, rows.count,
        RowLoadOp{rows, from, constants_.scalars, rigid, load, dt, exec_.view(now_.load)});
  }

  void solve(StepOutcome& outcome) {
    const SystemRows& rows = pattern_.rows();
    const auto values = const_view(now_.values), x = const_view(now_.x);
    const auto guess = const_view(now_.guess);
    exec_.for_each(linear_label, rows.count,
                   RowVelocityOp{rows, guess.size > 0 ? guess : const_view(now_.velocity),
                                 const_view(now_.prescribed), exec_.view(now_.x)});
    exec_.for_each(linear_label, rows.unknown_count,
                   RowPrescribedOp{rows, values, x, exec_.view(now_.load)});
    const GradientArrays<T> a = solve_.views(exec_, rows, model_.node_count, values,
                                             const_view(now_.load), exec_.view(now_.x));
    exec_.for_each(linear_label, rows.unknown_count, RowInvertOp<T>{rows, values, a.inverse});
    if constexpr (!std::is_same_v<T, double>) {
      exec_.for_each(linear_label, values.size, RoundOp{values, exec_.view(solve_.copy)});
    }
    const GradientOptions limits = {options_.linear_tolerance, options_.max_iterations,
                                    options_.progress || options_.clock != nullptr};
    const auto proceed = [&](std::int64_t iterations) {
      outcome.completed =
          outcome.completed && !(options_.progress && !options_.progress(iterations));
      const bool is_late = options_.clock != nullptr && iterations > 0 && options_.clock->is_over();
      return outcome.completed && !is_late;
    };
    islands_.solve(a, limits, proceed, [&](const GradientEnd& end) {
      outcome.converged &= end.is_converged;
      outcome.linear_iterations = std::max(outcome.linear_iterations, end.iterations);
      outcome.linear_residual = std::max(outcome.linear_residual, end.residual);
    });
    if (!outcome.completed) return;
    exec_.for_each(linear_label, rows.count, BlockVelocityOp{rows, x, exec_.view(now_.velocity)});
  }

  void update(double time_step) {
    const SystemRows& rows = pattern_.rows();
    const auto velocity = const_view(now_.velocity), fraction = const_view(now_.fraction);
    const std::int64_t nodes = fraction.size == 0 ? 0 : model_.node_count;
    // The velocities may be those of set_velocities(); those of prescribed blocks stay.
    exec_.for_each(update_label, rows.count,
                   RowVelocityOp{rows, velocity, velocity, exec_.view(now_.x)});
    exec_.for_each(update_label, rows.count - rows.unknown_count,
                   RowSupportOp{rows, const_view(now_.values), const_view(now_.x),
                                const_view(now_.load), exec_.view(now_.support)});
    exec_.for_each(
        update_label, 3 * std::int64_t{model_.node_count},
        NodeUpdateOp{velocity, time_step, {fraction.data, nodes}, exec_.view(now_.position)});
    exec_.for_each(update_label, model_.rigid_count,
                   RigidUpdateOp{velocity,
                                 model_.node_count,
                                 const_view(now_.inertia),
                                 time_step,
                                 {fraction.data + nodes, fraction.size - nodes},
                                 exec_.view(now_.center),
                                 exec_.view(now_.rotation),
                                 exec_.view(now_.angular_momentum)});
  }

  /// Rotations and blocks that the skips have left out; a device waits once for both.
  void count_skipped(StepOutcome& outcome) {
    const View<const std::uint8_t> tets = const_view(now_.tet_is_skipped);
    const View<const std::uint8_t> blocks = const_view(now_.block_is_skipped);
    const View<FlagCount> counts = exec_.view(counts_);
    exec_.sum_to(count_label, 0, tets.size, FlagCountOp{tets}, &counts[0]);
    exec_.sum_to(count_label, 0, blocks.size, FlagCountOp{blocks}, &counts[1]);
    FlagCount totals[2];
    exec_.get(View<const FlagCount>(counts), totals);
    outcome.skipped_rotations = totals[0].value;
    outcome.skipped_blocks = totals[1].value;
  }
  StepSeconds seconds() {
    const StageTimes& times = exec_.times();
    StepSeconds sums;
    sums.forces = times.of(forces_label);
    sums.assembly = times.of(assembly_label);
    sums.linear = times.of(linear_label);
    sums.update = times.of(update_label);
    sums.total = sums.forces + sums.assembly + sums.linear + sums.update;
    return sums;
  }

  template <class Array>
  auto const_view(const Array& own) const {
    return exec_.view(own);
  }

  Exec& exec_;
  IslandGradients<Exec>& islands_;
  const Model& model_;
  StepperOptions options_;
  PatternArrays<Exec> pattern_;
  ConstantArrays<Exec> constants_;
  StepArrays<Exec> now_;
  SolveArrays<Exec, T> solve_;
  HostSystem<Exec> system_;
  typename Exec::template Vector<FlagCount> counts_;  ///< [2] of count_skipped()
  std::vector<double> fraction_;                      ///< what now_.fraction holds
  double assembled_time_step_ = 0;                    ///< 0: no blocks are kept
};

}  // namespace tetwarp
