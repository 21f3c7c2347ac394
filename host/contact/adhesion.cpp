/// @file adhesion.cpp
/// evolve_adhesion() and evolve(): checks of arguments, and the stage "adhesion" on the host or on
/// a device.
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <tetwarp/contact.hpp>
#include <vector>

#include "host/base/vector_view.hpp"
#include "host/contact/cuda/device.hpp"
#include "host/contact/problem/checks.hpp"
#include "host/contact/problem/pressed_adhesion.hpp"
#include "host/contact/problem/spring_offset.hpp"
#include "host/contact/solver_state.hpp"
#include "host/exec/exec_cpu.hpp"
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

void check_evolution(const EvolutionOptions& options) {
  if (options.debond_gap_factor >= 1 && options.debond_intensity >= 0) return;
  throw std::invalid_argument(
      "EvolutionOptions: expected debond_gap_factor >= 1 and debond_intensity >= 0, got " +
      text_of(options.debond_gap_factor) + " and " + text_of(options.debond_intensity));
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
  check_evolution(options);
}

void check_arrays(const ContactArrays& arrays,
                  const ContactTarget& solution,
                  const AdhesionArrays& adhesion,
                  const ContactDevice* device) {
  const bool is_on_device = arrays.memory == Memory::device;
  if (!(arrays.time_step > 0)) throw std::invalid_argument("time_step: expected more than 0 s");
  if (arrays.memory != solution.memory) {
    throw std::invalid_argument("solution: its memory differs from that of the problem");
  }
  if (is_on_device && device == nullptr) {
    throw std::invalid_argument("arrays: device memory needs back end cuda");
  }
  const std::size_t contacts = arrays.friction.size();
  const auto check = [&](const std::string& name, auto array, std::size_t size, bool is_optional) {
    if (is_optional && array.empty()) return;
    if (array.size() != size) {
      throw std::invalid_argument(name + ": " + std::to_string(array.size()) +
                                  " numbers, expected " + std::to_string(size));
    }
    if (is_on_device && size > 0 && !device->is_device_memory(array.data())) {
      throw std::invalid_argument(name + ": not in memory of the device of this solver");
    }
  };
  check("intensity", arrays.intensity, contacts, false);
  check("solution.impulse", solution.impulse, 3 * contacts, false);
  check("solution.velocity", solution.velocity, 3 * contacts, false);
  check("adhesion.intensity", adhesion.intensity, contacts, false);
  check("adhesion.gap", adhesion.gap, 3 * contacts, false);
  check("adhesion.debonded", adhesion.debonded, contacts, true);
  check("velocity_offset", arrays.velocity_offset, 3 * contacts, true);
  check("gap", arrays.gap, 3 * contacts, true);
  check("area", arrays.area, contacts, true);
  check("stiffness", arrays.stiffness, contacts, true);
  check("tangential_stiffness", arrays.tangential_stiffness, contacts, true);
  check("adhesion.energy", adhesion.energy, contacts, true);
  check("adhesion.viscosity", adhesion.viscosity, contacts, true);
  check("adhesion.bonding_rate", adhesion.bonding_rate, contacts, true);
  check("adhesion.saturation_pressure", adhesion.saturation_pressure, contacts, true);
}

template <class T>
View<const double> numbers_of(const T& values) {
  return view_of(std::span<const double>(values));
}

/// @param springs  time_step, area, stiffness, tangential_stiffness, intensity and gap
/// @param rates    energy, viscosity, bonding_rate and saturation_pressure
template <class Springs, class Rates>
ContactAdhesionOp adhesion_op(const Springs& springs,
                              const Rates& rates,
                              View<const double> impulse,
                              View<const double> velocity,
                              const EvolutionOptions& options) {
  ContactAdhesionOp op{};
  op.in = {.time_step = springs.time_step,
           .area = numbers_of(springs.area),
           .stiffness = numbers_of(springs.stiffness),
           .tangential_stiffness = numbers_of(springs.tangential_stiffness),
           .intensity = numbers_of(springs.intensity),
           .gap = numbers_of(springs.gap),
           .energy = numbers_of(rates.energy),
           .viscosity = numbers_of(rates.viscosity),
           .bonding_rate = numbers_of(rates.bonding_rate),
           .saturation_pressure = numbers_of(rates.saturation_pressure),
           .impulse = impulse,
           .velocity = velocity};
  op.euler = options.integrator == AdhesionIntegrator::explicit_euler;
  op.debond_gap_factor = options.debond_gap_factor;
  op.debond_intensity = options.debond_intensity;
  return op;
}

/// On a device, or on this thread if there is none.
void run_adhesion(const ContactAdhesionOp& op, ContactDevice* device) {
  if (device != nullptr) return device->evolve(op);
  CpuExec exec(1, StageClocks::off);
  contact_adhesion(exec, op);
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
                             ContactDevice* device,
                             std::span<const double> pressing) {
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
  ContactAdhesionOp op =
      adhesion_op(adhesion, adhesion, numbers_of(solution.impulse), numbers_of(velocity), options);
  op.in.pressing = view_of(pressing);
  op.next_intensity = view_of(step.intensity);
  op.next_gap = view_of(step.gap);
  op.debonded = {step.debonded.data(), problem.contact_count()};
  run_adhesion(op, device);
  return step;
}

void ContactSolver::evolve(const ContactArrays& arrays,
                           const ContactTarget& solution,
                           const AdhesionArrays& adhesion,
                           const EvolutionOptions& options) {
  ContactDevice* const device = state_->device.get();
  check_evolution(options);
  check_arrays(arrays, solution, adhesion, device);
  ContactAdhesionOp op = adhesion_op(arrays, adhesion, numbers_of(solution.impulse),
                                     numbers_of(solution.velocity), options);
  op.in.velocity_offset = view_of(arrays.velocity_offset);
  op.next_intensity = view_of(adhesion.intensity);
  op.next_gap = view_of(adhesion.gap);
  op.debonded = view_of(adhesion.debonded);
  if (arrays.memory == Memory::device) return device->evolve_resident(op, solution.stream);
  run_adhesion(op, device);
}

}  // namespace tetwarp
