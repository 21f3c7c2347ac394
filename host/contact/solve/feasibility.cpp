/// @file feasibility.cpp
/// Sweeps over the contacts without friction and springs, whose growing impulses show
/// contradictions.
#include "host/contact/solve/feasibility.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/contact/contact_pipeline.hpp"

namespace tetwarp {
namespace {
/// The same contacts without friction and springs.
ContactSystem<double> make_bare(const ContactSystem<double>& system) {
  ContactSystem<double> bare = system;
  for (ContactConstants<double>& c : bare.constants) {
    c.friction = c.normal_spring = c.tangent_spring = 0;
    c.kind = ContactKind::frictionless;
  }
  return bare;
}

/// Sets the state of an island to that without impulses.
void start_island(const ContactNumbers<double>& numbers,
                  const ContactIsland& island,
                  StateMemory<CpuExec, double>& state) {
  const std::int64_t slot = 3 * island.slot_begin, size = 3 * island.contact_count();
  std::fill_n(state.impulse.begin() + slot, size, 0.0);
  std::copy_n(numbers.free_velocity.data + slot, size, state.velocity.begin() + slot);
  if (numbers.is_local) return;
  std::copy(numbers.body_free.data + island.dof_begin, numbers.body_free.data + island.dof_end,
            state.body_velocity.begin() + island.dof_begin);
}

/// y . B y for impulses y of the pipeline's island. The impulses of the pipeline are kept, and its
/// velocities recomputed from them.
double energy_of(ContactPipeline<CpuExec, double>& pipeline, const std::vector<double>& y) {
  const View<double> impulse = pipeline.impulse();
  const std::vector<double> kept(impulse.data, impulse.data + impulse.size);
  std::copy(y.begin(), y.end(), impulse.data);
  pipeline.follow_impulses();
  const double energy = std::max(pipeline.measure().work, 0.0);
  std::copy(kept.begin(), kept.end(), impulse.data);
  pipeline.follow_impulses();
  return energy;
}
/// Whether the last of `sweeps` sweeps has added to any impulse about as much as a steady growth
/// from the first one, 1 / sweeps of it; impulses that converge fall behind that.
bool grows_steadily(View<const double> impulse,
                    const std::vector<double>& growth,
                    std::int64_t sweeps) {
  for (std::size_t i = 0; i < growth.size(); ++i) {
    const double steady = impulse.data[i] / static_cast<double>(sweeps);
    if (growth[i] > 0.01 * steady) return true;
  }
  return false;
}
}  // namespace

std::vector<std::int64_t> contradicting_slots(const ContactStructure& structure,
                                              const ContactSystem<double>& system,
                                              const ContactIsland& island,
                                              const ContradictionSearch& search,
                                              ContradictionMemory& memory,
                                              SolveBudget* budget) {
  // A distance counts as infinite if it is larger by this factor than that of single contacts.
  constexpr double far = 1e7;
  for (std::int64_t s = island.slot_begin; s < island.slot_end; ++s) {
    if (!is_contact(system.constants[index_of(s)].kind)) return {};
  }
  CpuExec exec(1, StageClocks::off);
  if (!memory.bare) {
    memory.bare = make_bare(system);
    memory.state.reset(exec, memory.bare->numbers(structure.indices()), false);
  }
  const ContactSystem<double>& bare = *memory.bare;
  const ContactNumbers<double> numbers = bare.numbers(structure.indices());
  start_island(numbers, island, memory.state);
  ContactPipeline<CpuExec, double> pipeline(exec, numbers, view_of(structure.color_start), island,
                                            {}, memory.state.views());
  double required = 0;
  for (std::int64_t s = island.slot_begin; s < island.slot_end; ++s) {
    const auto slot = static_cast<std::size_t>(s);
    const double approach = std::min(bare.free_velocity[3 * slot], 0.0);
    required += approach * approach / bare.constants[slot].block[0];
  }
  const View<double> y = pipeline.impulse();
  std::vector<double> before(static_cast<std::size_t>(y.size));
  for (std::int64_t sweep = 1; sweep <= search.max_sweeps; ++sweep) {
    std::copy_n(y.data, y.size, before.data());
    pipeline.sweep({});
    if (budget != nullptr && budget->is_over()) return {};
    if ((sweep & (sweep - 1)) != 0) continue;  // the test is made at powers of two only
    // y is what the last sweep added to the impulses; B y is the velocity change it causes.
    std::vector<double> growth(before.size());
    for (std::size_t i = 0; i < growth.size(); ++i) {
      growth[i] = std::max(y.data[i] - before[i], 0.0);
    }
    const double largest = *std::max_element(growth.begin(), growth.end());
    if (!(largest > 0)) return {};
    if (search.stops_early && !grows_steadily(y, growth, sweep)) return {};
    for (double& entry : growth) entry /= largest;  // squares of tiny numbers would underflow
    const double energy = energy_of(pipeline, growth);
    double gain = 0;
    for (std::size_t i = 0; i < growth.size(); ++i) {
      gain -= growth[i] * bare.free_velocity[static_cast<std::size_t>(3 * island.slot_begin) + i];
    }
    if (!(gain > 0 && gain > far * std::sqrt(energy * required))) continue;
    std::vector<std::int64_t> slots;
    for (std::int64_t s = island.slot_begin; s < island.slot_end; ++s) {
      const auto own = static_cast<std::size_t>(3 * (s - island.slot_begin));
      if (growth[own] > 1e-6) slots.push_back(s);
    }
    return slots;
  }
  return {};
}

EngineResult solve_feasible(const ContactProblem& given,
                            std::optional<ContactProblem> changed,
                            const std::function<EngineResult(const ContactProblem&)>& solve_round) {
  std::vector<std::int32_t> clamped;
  double speed = 0;
  // Each round raises at least one more offset; one or two rounds are usual.
  for (;;) {
    EngineResult result = solve_round(changed ? *changed : given);
    speed = std::max(speed, result.clamped_speed);
    result.clamped_speed = speed;
    if (result.clamped.empty()) {
      result.clamped = std::move(clamped);
      return result;
    }
    if (!changed) changed = given;
    std::vector<double>& offsets =
        changed->is_local() ? changed->free_velocity : changed->velocity_offset;
    bool is_new = false;
    for (const std::int32_t c : result.clamped) {
      double& offset = offsets[3 * index_of(c)];
      is_new = is_new || offset < 0;
      offset = std::max(offset, 0.0);
    }
    if (!is_new) {
      result.clamped.insert(result.clamped.end(), clamped.begin(), clamped.end());
      return result;
    }
    clamped.insert(clamped.end(), result.clamped.begin(), result.clamped.end());
    changed->impulse_guess.clear();
  }
}

}  // namespace tetwarp
