/// @file feasibility.cpp
#include "host/contact/feasibility.hpp"

#include <algorithm>
#include <cmath>

#include "host/exec/contact_exec_cpu.hpp"
#include "kernels/contact/contact_memory.hpp"
#include "kernels/contact/contact_pipeline.hpp"

namespace tetwarp {

namespace {

/// A frictionless, springless twin of the contacts.
ContactSystem<double> make_bare(const ContactSystem<double>& system) {
  ContactSystem<double> bare = system;
  for (ContactConstants<double>& c : bare.constants) {
    c.friction = c.normal_spring = c.tangent_spring = 0;
    c.kind = ContactKind::frictionless;
  }
  return bare;
}

}  // namespace

std::vector<std::int64_t> contradicting_slots(const ContactStructure& structure,
                                              const ContactSystem<double>& system,
                                              const ContactIsland& island,
                                              std::int64_t budget) {
  const std::int64_t sweeps = std::min<std::int64_t>(budget, 4096);
  constexpr double far = 1e7;  // times the distance that the contacts ask for one by one
  const ContactSystem<double> bare = make_bare(system);
  const ContactNumbers<double> numbers = bare.numbers(structure.indices());
  CpuContactExec exec(1);
  StateMemory<CpuContactExec, double> state;
  state.reset(exec, numbers, false);
  ContactPipeline<CpuContactExec, double> pipeline(exec, numbers, view_of(structure.color_start),
                                                   island, {}, state.views());
  double wanted = 0;
  for (std::int64_t s = island.slot_begin; s < island.slot_end; ++s) {
    const auto slot = static_cast<std::size_t>(s);
    const double approach = std::min(bare.free_velocity[3 * slot], 0.0);
    wanted += approach * approach / bare.constants[slot].block[0];
  }
  const View<double> y = pipeline.impulse();
  std::vector<double> before(static_cast<std::size_t>(y.size));
  for (std::int64_t sweep = 1; sweep <= sweeps; ++sweep) {
    std::copy_n(y.data, y.size, before.data());
    pipeline.sweep({});
    if ((sweep & (sweep - 1)) != 0) continue;  // powers of two are often enough
    // The last growth as y: what it does to velocities is B y.
    std::vector<double> growth(before.size());
    for (std::size_t i = 0; i < growth.size(); ++i) {
      growth[i] = std::max(y.data[i] - before[i], 0.0);
    }
    const double most = *std::max_element(growth.begin(), growth.end());
    if (!(most > 0)) return {};
    for (double& entry : growth) entry /= most;  // squares of tiny growths would vanish
    const std::vector<double> impulse(y.data, y.data + y.size);
    std::copy(growth.begin(), growth.end(), y.data);
    pipeline.follow_impulses();
    const double energy = std::max(pipeline.measure().work, 0.0);
    double gain = 0;
    for (std::size_t i = 0; i < growth.size(); ++i) {
      gain -= growth[i] * bare.free_velocity[static_cast<std::size_t>(3 * island.slot_begin) + i];
    }
    std::copy(impulse.begin(), impulse.end(), y.data);
    pipeline.follow_impulses();
    if (!(gain > 0 && gain > far * std::sqrt(energy * wanted))) continue;
    std::vector<std::int64_t> slots;
    for (std::int64_t s = island.slot_begin; s < island.slot_end; ++s) {
      const auto own = static_cast<std::size_t>(3 * (s - island.slot_begin));
      if (growth[own] > 1e-6) slots.push_back(s);
    }
    return slots;
  }
  return {};
}

}  // namespace tetwarp
