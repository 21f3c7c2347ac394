/// @file adhesion.cpp
/// evolve_adhesion(): checks of its arguments, and the stage "adhesion" on the host or on a device.
#include <cmath>
#include <stdexcept>
#include <string>
#include <tetwarp/contact.hpp>
#include <utility>
#include <vector>

#include "host/contact/cuda/device.hpp"
#include "host/contact/problem/checks.hpp"
#include "host/contact/problem/spring_offset.hpp"
#include "host/exec/contact_exec_cpu.hpp"
#include "kernels/contact/contact_adhesion.hpp"

namespace tetwarp {
namespace {
void check_adhesion(const AdhesionState& adhesion, std::int64_t contact_count) {
  if (!(adhesion.time_step > 0)) {
    throw ContactProblemError("adhesion.time_step",
                              ": expected more than 0 s, got " + text_of(adhesion.time_step));
  }
  const auto check_length = [&](const char* name, const std::vector<double>& values, int per = 1) {
    if (values.empty()) return;
    check_size(name, values.size(), per * contact_count, per == 1 ? "contacts" : "3 contacts");
  };
  check_length("adhesion.area", adhesion.area);
  check_length("adhesion.stiffness", adhesion.stiffness);
  check_length("adhesion.tangential_stiffness", adhesion.tangential_stiffness);
  check_length("adhesion.intensity", adhesion.intensity);
  check_length("adhesion.gap", adhesion.gap, 3);
  check_length("adhesion.energy", adhesion.energy);
  check_length("adhesion.viscosity", adhesion.viscosity);
  check_length("adhesion.bonding_rate", adhesion.bonding_rate);
  check_length("adhesion.saturation_pressure", adhesion.saturation_pressure);
}

void check_arguments(const ContactProblem& problem,
                     const ContactSolution& solution,
                     const EvolutionOptions& options) {
  check_adhesion(problem.adhesion, problem.contact_count());
  const auto rows = static_cast<std::size_t>(3 * problem.contact_count());
  if (solution.impulse.size() != rows || solution.velocity.size() != rows) {
    throw std::invalid_argument("solution: expected impulse and velocity of " +
                                std::to_string(rows) + " rows, got " +
                                std::to_string(solution.impulse.size()) + " and " +
                                std::to_string(solution.velocity.size()));
  }
  if (!(options.debond_gap_factor >= 1) || !(options.debond_intensity >= 0)) {
    throw std::invalid_argument(
        "EvolutionOptions: expected debond_gap_factor >= 1 and debond_intensity >= 0, got " +
        text_of(options.debond_gap_factor) + " and " + text_of(options.debond_intensity));
  }
}
}  // namespace

AdhesionStep evolve_adhesion(const ContactProblem& problem,
                             const ContactSolution& solution,
                             const EvolutionOptions& options) {
  return evolve_adhesion(problem, solution, options, nullptr);
}

AdhesionStep evolve_adhesion(const ContactProblem& problem,
                             const ContactSolution& solution,
                             const EvolutionOptions& options,
                             ContactDevice* device) {
  const AdhesionState& adhesion = problem.adhesion;
  if (adhesion.empty()) return {};
  check_arguments(problem, solution, options);

  AdhesionStep step;
  step.intensity.resize(problem.friction.size());
  step.gap.resize(3 * problem.friction.size());
  step.debonded.resize(problem.friction.size());
  // Springs are as long as gap_n + dt (u_n - w_n).
  std::vector<double> velocity = solution.velocity;
  const std::vector<double> offsets = normal_offsets(problem);
  for (std::size_t c = 0; c < offsets.size(); ++c) velocity[3 * c] += offsets[c];
  const AdhesionViews views{.time_step = adhesion.time_step,
                            .area = view_of(adhesion.area),
                            .stiffness = view_of(adhesion.stiffness),
                            .tangential_stiffness = view_of(adhesion.tangential_stiffness),
                            .intensity = view_of(adhesion.intensity),
                            .gap = view_of(adhesion.gap),
                            .energy = view_of(adhesion.energy),
                            .viscosity = view_of(adhesion.viscosity),
                            .bonding_rate = view_of(adhesion.bonding_rate),
                            .saturation_pressure = view_of(adhesion.saturation_pressure),
                            .impulse = view_of(solution.impulse),
                            .velocity = view_of(std::as_const(velocity))};
  const ContactAdhesionBody body = {
      .in = views,
      .euler = options.integrator == AdhesionIntegrator::explicit_euler,
      .debond_gap_factor = options.debond_gap_factor,
      .debond_intensity = options.debond_intensity,
      .next_intensity = view_of(step.intensity),
      .next_gap = view_of(step.gap),
      .debonded = {step.debonded.data(), problem.contact_count()},
  };
  if (device != nullptr) {
    device->evolve(body);
  } else {
    contact_adhesion(CpuContactExec(1), body);
  }
  return step;
}

}  // namespace tetwarp
