/// @file contact_system.cpp
#include "host/contact_system.hpp"

#include <algorithm>

#include "host/contact_exec_cpu.hpp"
#include "kernels/body_relax.hpp"

namespace tetwarp {

namespace {

std::size_t index_of(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

/// Adds stored numbers up where they belong; zeros may have no place.
void scatter(const std::vector<double>& values,
             const std::vector<std::int64_t>& target,
             std::int64_t size,
             std::vector<double>& out) {
  out.assign(index_of(size), 0.0);
  for (std::size_t e = 0; e < values.size(); ++e) {
    if (target[e] >= 0) out[index_of(target[e])] += values[e];
  }
}

double entry_of(const std::vector<double>& values, std::size_t i) {
  return values.empty() ? 0.0 : values[i];
}

/// Springs and friction of one contact; its block comes later.
ContactConstants<double> make_constants(const ContactProblem& problem,
                                        const ContactSkipOptions& skip,
                                        std::size_t c,
                                        ContactSavings& savings) {
  const AdhesionState& adhesion = problem.adhesion;
  ContactConstants<double> constants = {};
  constants.friction = problem.friction[c];
  constants.kind = ContactKind::coulomb;
  if (!adhesion.empty()) {
    const double dt = adhesion.time_step;
    const double beta = adhesion.intensity[c];
    const double normal = entry_of(adhesion.stiffness, c);
    const double tangent =
        adhesion.tangential_stiffness.empty() ? normal : adhesion.tangential_stiffness[c];
    const double scale = dt * dt * entry_of(adhesion.area, c) * beta * beta;
    constants.normal_spring = scale * normal;
    constants.tangent_spring = scale * tangent;
    if (!adhesion.gap.empty() && dt > 0) {
      constants.tangent_offset[0] = adhesion.gap[3 * c + 1] / dt;
      constants.tangent_offset[1] = adhesion.gap[3 * c + 2] / dt;
    }
    if (beta == 0 && skip.debonded_springs) {
      ++savings.springs;
    } else {
      constants.kind = ContactKind::adhesive;
    }
  }
  if (constants.friction == 0 && constants.tangent_spring == 0 && skip.frictionless_rows) {
    constants.kind = ContactKind::frictionless;
    savings.rows += 2;
  }
  return constants;
}

/// Inverse blocks, responses, free velocities. Coupled islands have D for A and omega in front.
void fill_responses(const ContactOptions& options,
                    const ContactStructure& structure,
                    ContactSystem<double>& system) {
  CpuContactExec exec(1);
  system.inverse.resize(index_of(structure.inverse_start.back()));
  for (std::size_t b = 0; b + 1 < structure.inverse_start.size(); ++b) {
    std::copy_n(system.system.begin() + structure.diagonal_value[b],
                structure.inverse_start[b + 1] - structure.inverse_start[b],
                system.inverse.begin() + structure.inverse_start[b]);
  }
  block_invert(exec, view_of(structure.dof_start), view_of(structure.inverse_start),
               view_of(system.inverse));
  system.response.resize(system.jacobian.size());
  system.body_free.assign(system.load.size(), 0.0);
  for (const ContactIsland& island : structure.islands) {
    const std::int64_t contacts = island.contact_count();
    PairView pairs = structure.pairs();
    pairs.pair_start = {pairs.pair_start.data + island.slot_begin, contacts + 1};
    contact_response(
        exec, ContactResponseBody<double>{pairs,
                                          view_of(system.jacobian),
                                          view_of(structure.inverse_start),
                                          view_of(system.inverse),
                                          island.is_coupled ? options.relaxation : 1,
                                          view_of(system.response),
                                          {system.constants.data() + island.slot_begin, contacts}});
    if (island.is_coupled) continue;
    body_relax(exec, island.block_begin, island.block_end,
               BodyRelaxBody<double>{view_of(structure.dof_start), view_of(structure.inverse_start),
                                     view_of(system.inverse), 1.0, view_of(system.load),
                                     view_of(system.body_free)});
  }
}

void fill_global(const ContactOptions& options,
                 const ContactProblem& problem,
                 const ContactStructure& structure,
                 ContactSystem<double>& system) {
  system.load.resize(problem.load.size());
  for (std::size_t d = 0; d < system.load.size(); ++d) {
    system.load[d] = problem.load[index_of(structure.dof_of_place[d])];
  }
  fill_responses(options, structure, system);
  const BodiesView<double> bodies = system.bodies_view(structure);
  for (std::size_t s = 0; s < structure.contact_of_slot.size(); ++s) {
    bodies.velocity_at(static_cast<std::int64_t>(s), system.body_free.data(),
                       system.free_velocity.data() + 3 * s);
  }
}

void fill_local(const ContactStructure& structure, ContactSystem<double>& system) {
  for (std::size_t s = 0; s < structure.contact_of_slot.size(); ++s) {
    std::copy_n(system.delassus.begin() + 9 * structure.delassus_diagonal[s], 9,
                system.constants[s].block);
  }
  CpuContactExec exec(1);
  exec.for_each("contact/setup", static_cast<std::int64_t>(system.constants.size()),
                ContactMetricBody<double>{view_of(system.constants)});
}

template <class To, class From>
std::vector<To> rounded(const std::vector<From>& values) {
  return {values.begin(), values.end()};
}

}  // namespace

void fill_system(const ContactProblem& problem,
                 const ContactOptions& options,
                 const ContactStructure& structure,
                 ContactSystem<double>& system,
                 ContactSavings& savings) {
  if (structure.is_local) {
    scatter(problem.delassus.value, structure.delassus_target,
            9 * static_cast<std::int64_t>(structure.delassus_column.size()), system.delassus);
  } else {
    scatter(problem.system.value, structure.system_target, structure.system_size, system.system);
    scatter(problem.jacobian.value, structure.jacobian_target, structure.jacobian_size,
            system.jacobian);
  }
  const std::vector<double>& given =
      structure.is_local ? problem.free_velocity : problem.velocity_offset;
  std::vector<double>& kept = structure.is_local ? system.free_velocity : system.offset;
  const std::size_t slots = structure.contact_of_slot.size();
  kept.resize(3 * slots);
  system.free_velocity.resize(3 * slots);
  system.constants.clear();
  savings = {};
  for (std::size_t s = 0; s < slots; ++s) {
    const std::size_t c = index_of(structure.contact_of_slot[s]);
    std::copy_n(given.begin() + 3 * static_cast<std::int64_t>(c), 3,
                kept.begin() + 3 * static_cast<std::int64_t>(s));
    system.constants.push_back(make_constants(problem, options.skip, c, savings));
  }
  if (structure.is_local) {
    fill_local(structure, system);
  } else {
    fill_global(options, problem, structure, system);
  }
}

ContactSystem<float> make_float32(const ContactSystem<double>& system) {
  ContactSystem<float> result;
  for (const ContactConstants<double>& c : system.constants) {
    ContactConstants<float> rounded_constants = {};
    for (int e = 0; e < 9; ++e) rounded_constants.block[e] = static_cast<float>(c.block[e]);
    rounded_constants.tangent_metric = static_cast<float>(c.tangent_metric);
    rounded_constants.friction = static_cast<float>(c.friction);
    rounded_constants.normal_spring = static_cast<float>(c.normal_spring);
    rounded_constants.tangent_spring = static_cast<float>(c.tangent_spring);
    for (int a = 0; a < 2; ++a) {
      rounded_constants.tangent_offset[a] = static_cast<float>(c.tangent_offset[a]);
    }
    rounded_constants.kind = c.kind;
    result.constants.push_back(rounded_constants);
  }
  result.free_velocity = rounded<float>(system.free_velocity);
  result.offset = rounded<float>(system.offset);
  result.load = rounded<float>(system.load);
  result.jacobian = rounded<float>(system.jacobian);
  result.response = rounded<float>(system.response);
  result.inverse = rounded<float>(system.inverse);
  result.system = rounded<float>(system.system);
  result.body_free = rounded<float>(system.body_free);
  result.delassus = rounded<float>(system.delassus);
  return result;
}

}  // namespace tetwarp
