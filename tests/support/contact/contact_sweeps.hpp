/// @file contact_sweeps.hpp
/// Contact sweeps on the host, contact by contact, to compare devices with.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/structure/structure.hpp"
#include "host/contact/structure/system.hpp"
#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/contact_memory.hpp"
#include "kernels/contact/contact_pipeline.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::test {

/// A problem as the stages read it.
struct SweepScene {
  ContactStructure structure;
  ContactSystem<double> system;

  SweepScene(const ContactProblem& problem, bool separates_islands)
      : structure(make_structure(problem, {.converged_islands = separates_islands})) {
    ContactSavings savings;
    fill_system(problem, {}, structure, system, savings);
  }
};

/// Only the first contacts of a global problem.
inline ContactProblem first_contacts(ContactProblem problem, std::int64_t count) {
  const auto contacts = static_cast<std::size_t>(count);
  problem.jacobian.rows = 3 * count;
  problem.jacobian.row_start.resize(3 * contacts + 1);
  problem.jacobian.column.resize(static_cast<std::size_t>(problem.jacobian.row_start.back()));
  problem.jacobian.value.resize(problem.jacobian.column.size());
  problem.velocity_offset.resize(3 * contacts);
  problem.friction.resize(contacts);
  AdhesionState& glue = problem.adhesion;
  for (std::vector<double>* values :
       {&glue.area, &glue.stiffness, &glue.tangential_stiffness, &glue.intensity, &glue.energy,
        &glue.viscosity, &glue.bonding_rate, &glue.saturation_pressure}) {
    if (!values->empty()) values->resize(contacts);
  }
  if (!glue.gap.empty()) glue.gap.resize(3 * contacts);
  return problem;
}

/// Results of the host for one island.
template <class T>
struct HostSweeps {
  std::vector<T> impulse;  ///< [3 contacts of the island]
  ContactSums sums;
};

template <class T>
HostSweeps<T> sweep_on_host(const ContactStructure& structure,
                            const ContactSystem<T>& system,
                            const ContactIsland& island,
                            ContactSwitches switches,
                            const std::vector<T>& start,
                            std::int64_t sweeps) {
  CpuExec exec(1);
  const ContactNumbers<T> numbers = system.numbers(structure.indices());
  StateMemory<CpuExec, T> state;
  state.reset(exec, numbers, false);
  state.impulse = start;
  ContactPipeline<CpuExec, T> pipeline(exec, numbers, view_of(structure.color_start), island,
                                       switches, state.views());
  pipeline.follow_impulses();
  for (std::int64_t s = 0; s < sweeps; ++s) pipeline.sweep({});
  const View<T> r = pipeline.impulse();
  return {{r.data, r.data + r.size}, pipeline.measure()};
}

/// The part of all impulses that belongs to an island.
template <class T>
std::vector<T> part_of(const std::vector<T>& impulse, const ContactIsland& island) {
  return {impulse.begin() + 3 * island.slot_begin, impulse.begin() + 3 * island.slot_end};
}

}  // namespace tetwarp::test
