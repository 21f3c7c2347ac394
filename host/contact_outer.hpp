/// @file contact_outer.hpp
/// Contacts of bodies that A couples, by an outer block-Jacobi iteration around sweeps.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/contact_accelerators.hpp"
#include "host/contact_coupled.hpp"
#include "host/contact_pipeline.hpp"

namespace tetwarp {

/// Outer step: v_f = v - omega D^-1 (A v - b); inner sweeps solve the contacts in the metric of D /
/// omega, v = v_f + omega D^-1 J^T r (proximal gradients; converges for omega up to 2 / lambda_max
/// of D^-1 A, at most 2 / nodes per element). Anderson acceleration, where asked for, is on v.
/// Source: Gascon 2010 (iterative constraint anticipation); the relaxation is ours.
template <class Exec>
class OuterIteration {
 public:
  using Vector = std::vector<double>;

  OuterIteration(Exec& exec,
                 const ContactOptions& options,
                 const ContactStructure& structure,
                 const ContactSystem<double>& system,
                 CoupledIsland<Exec>& island)
      : exec_(exec),
        options_(options),
        island_(island),
        pipeline_(exec, structure, system, island.island(), switches_of(options), state_),
        weights_(diagonal_of(structure, system, island.island())) {}

  /// @param guess  [3 slots] to start from, or empty
  IslandOutcome solve(const Vector& guess) {
    const bool is_accelerated = options_.method == ContactMethod::anderson;
    IslandOutcome outcome;
    outcome.methods = {is_accelerated ? "outer_anderson" : "outer_jacobi"};
    island_.start(guess, outcome);
    state_.impulse = island_.impulse();
    state_.body_velocity = island_.body_velocity();
    state_.defect.resize(state_.body_velocity.size());
    const View<double> v = pipeline_.body_velocity();
    AndersonMixer<Exec, double> mixer(exec_, weights_);
    Vector before(static_cast<std::size_t>(v.size));
    while (outcome.sweeps < options_.max_sweeps) {
      std::copy_n(v.data, v.size, before.data());
      pipeline_.find_defect();
      pipeline_.relax(options_.relaxation);
      for (int sweep = 0; sweep < options_.inner_sweeps; ++sweep) pipeline_.sweep({});
      outcome.sweeps += options_.inner_sweeps;
      ++outcome.outer_iterations;
      const bool is_last = outcome.sweeps >= options_.max_sweeps;
      if ((is_last || outcome.outer_iterations % check_every == 0) && judge(outcome) <= 1) break;
      if (!is_accelerated) continue;
      const View<const double> x = {before.data(), v.size};
      mixer.mix(x, v, defect_of(exec_, weights_, x, View<const double>(v)));
    }
    outcome.contact_updates = outcome.sweeps * island_.island().contact_count();
    return outcome;
  }

 private:
  static constexpr std::int64_t check_every = 4;  ///< judging costs about as much as a step

  double judge(IslandOutcome& outcome) {
    pipeline_.find_defect();
    island_.impulse() = state_.impulse;
    island_.body_velocity() = state_.body_velocity;
    island_.defect() = state_.defect;
    island_.find_velocity();
    return island_.judge(state_.impulse, outcome);
  }

  /// The diagonal of A: about the metric of the outer iteration.
  static std::vector<double> diagonal_of(const ContactStructure& structure,
                                         const ContactSystem<double>& system,
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

  Exec& exec_;
  const ContactOptions& options_;
  CoupledIsland<Exec>& island_;
  ContactState<double> state_;
  ContactPipeline<Exec, double> pipeline_;
  std::vector<double> weights_;
};

}  // namespace tetwarp
