/// @file contact_arrays.hpp
/// Contact problems whose arrays are in memory of a device, for tests on the emulated device and on
/// a real one.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/error.hpp>

#include "host/base/warp_backend.hpp"
#include "kernels/exec/exec_stream.cuh"
#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_scenes.hpp"
#include "tests/support/device_array.hpp"

namespace tetwarp::test {

/// The numbers of a problem as views of its own memory.
inline ContactArrays arrays_of(const ContactProblem& problem) {
  ContactArrays arrays;
  arrays.system = problem.system.value;
  arrays.jacobian = problem.jacobian.value;
  arrays.load = problem.load;
  arrays.velocity_offset = problem.velocity_offset;
  arrays.delassus = problem.delassus.value;
  arrays.free_velocity = problem.free_velocity;
  arrays.friction = problem.friction;
  arrays.time_step = problem.adhesion.time_step;
  arrays.area = problem.adhesion.area;
  arrays.stiffness = problem.adhesion.stiffness;
  arrays.tangential_stiffness = problem.adhesion.tangential_stiffness;
  arrays.intensity = problem.adhesion.intensity;
  arrays.gap = problem.adhesion.gap;
  arrays.impulse_guess = problem.impulse_guess;
  return arrays;
}

/// The numbers of a problem, and its results, in memory of the device.
class DeviceProblem {
 public:
  explicit DeviceProblem(const ContactProblem& problem)
      : impulse(3 * problem.friction.size()),
        velocity(3 * problem.friction.size()),
        body_velocity(problem.load.size()) {
    arrays = arrays_of(problem);
    arrays.memory = Memory::device;
    for (std::span<const double>* const array :
         {&arrays.system, &arrays.jacobian, &arrays.load, &arrays.velocity_offset, &arrays.delassus,
          &arrays.free_velocity, &arrays.friction, &arrays.area, &arrays.stiffness,
          &arrays.tangential_stiffness, &arrays.intensity, &arrays.gap, &arrays.impulse_guess}) {
      copies_.emplace_back(std::vector<double>(array->begin(), array->end()));
      *array = copies_.back().span();
    }
  }

  ContactTarget target(void* stream = nullptr) const {
    return {impulse.target(), velocity.target(), body_velocity.target(), Memory::device, stream};
  }

  ContactArrays arrays;
  DeviceArray impulse, velocity, body_velocity;

 private:
  std::vector<DeviceArray> copies_;
};

inline void expect_results(const DeviceProblem& problem,
                           const ContactReport& report,
                           const ContactSolution& wanted,
                           const std::string& what) {
  EXPECT_EQ(problem.impulse.get(), wanted.impulse) << what;
  EXPECT_EQ(problem.velocity.get(), wanted.velocity) << what;
  EXPECT_EQ(problem.body_velocity.get(), wanted.body_velocity) << what;
  EXPECT_EQ(report.status, wanted.report.status) << what;
  EXPECT_EQ(report.sweeps, wanted.report.sweeps) << what;
  EXPECT_EQ(report.islands, wanted.report.islands) << what;
  EXPECT_EQ(report.colors, wanted.report.colors) << what;
  EXPECT_EQ(report.contact_updates, wanted.report.contact_updates) << what;
  EXPECT_EQ(report.residual.eta, wanted.report.residual.eta) << what;
  EXPECT_EQ(report.residual.largest_contact, wanted.report.residual.largest_contact) << what;
  EXPECT_EQ(report.residual_history, wanted.report.residual_history) << what;
  EXPECT_NEAR(report.residual.balance, wanted.report.residual.balance,
              1e-6 * wanted.report.residual.balance + 1e-15)
      << what;
}

/// Spheres with springs, whose normal gaps are those of the step.
inline ContactProblem sticky_packing(std::uint32_t seed, int edge) {
  ContactProblem problem = scenes::sphere_packing({.seed = seed, .edge = edge, .kept = 0.4});
  const std::size_t contacts = problem.friction.size();
  AdhesionState& adhesion = problem.adhesion;
  adhesion.time_step = 1e-3;
  adhesion.area.assign(contacts, 1e-4);
  adhesion.stiffness.assign(contacts, 1e8);
  adhesion.intensity.assign(contacts, 0.0);
  adhesion.gap.assign(3 * contacts, 0.0);
  for (std::size_t c = 0; c < contacts; ++c) {
    adhesion.intensity[c] = c % 3 == 0 ? 0.0 : 0.5;
    adhesion.gap[3 * c] = 1e-3 * problem.velocity_offset[3 * c];
    adhesion.gap[3 * c + 1] = 1e-6 * static_cast<double>(c % 5);
  }
  return problem;
}

class ContactArraysOnDevice : public testing::Test {
 protected:
  void SetUp() override {
    const BackendStatus status = cuda_status(0);
    if (!status.usable) GTEST_SKIP() << status.reason;
  }
};

TEST_F(ContactArraysOnDevice, GiveTheBitsOfHostArrays) {
  ContactProblem guessed = scenes::sphere_packing({.seed = 41, .edge = 4, .kept = 0.4});
  guessed.impulse_guess = solve_contacts(guessed, {.tolerance = 1e-3}).impulse;
  ContactProblem joints = global_problem(42, 9, 0);
  const struct {
    const char* name;
    ContactProblem problem;
    ContactOptions options;
  } cases[] = {{"packing", scenes::sphere_packing({.seed = 43, .edge = 4, .kept = 0.4}), {}},
               {"guess", guessed, {}},
               {"springs", sticky_packing(44, 4), {}},
               {"bodies", joints, {}},
               {"local", local_problem(45, 30), {}},
               {"large",
                scenes::random_local({.seed = 46, .contacts = 2100, .neighbors = 2}),
                {.tolerance = 1e-3, .expert = {.skip = {.converged_islands = false}}}},
               {"watched",
                scenes::random_local({.seed = 46, .contacts = 2100, .neighbors = 2}),
                {.tolerance = 1e-3,
                 .expert = {.skip = {.converged_islands = false}},
                 .max_seconds = 1e6,
                 .progress = [](const ContactProgress&) { return true; }}},
               {"gauss seidel",
                scenes::sphere_packing({.seed = 47, .edge = 4, .kept = 0.4}),
                {.method = ContactMethod::gauss_seidel, .tolerance = 1e-4}},
               {"recovery",
                scenes::sphere_packing({.seed = 48, .edge = 4, .kept = 0.4}),
                {.recovery_speed = 1e-3}},
               {"float32",
                scenes::sphere_packing({.seed = 49, .edge = 4, .kept = 0.4}),
                {.tolerance = 1e-3, .precision = ContactPrecision::float32}},
               {"through the host",
                scenes::sphere_packing({.seed = 50, .edge = 4, .kept = 0.4}),
                {.tolerance = 1e-13, .max_sweeps = 40}}};
  for (const auto& [name, problem, options] : cases) {
    ContactOptions on_device = options;
    on_device.backend = Backend::cuda;
    ContactSolver host(on_device), solver(on_device);
    const ContactSolution wanted = host.solve(problem);
    const DeviceProblem device(problem);
    solver.set_structure(problem);
    for (int round = 0; round < 2; ++round) {
      const ContactReport report = solver.solve(device.arrays, device.target());
      expect_results(device, report, wanted, std::string(name) + " round " + std::to_string(round));
    }
  }
}

/// Sets what couples the first dof with others to zero: another pattern of zeros.
inline void uncouple_first_dof(SparseMatrix& system) {
  for (std::size_t row = 0; row + 1 < system.row_start.size(); ++row) {
    for (auto e = static_cast<std::size_t>(system.row_start[row]);
         e < static_cast<std::size_t>(system.row_start[row + 1]); ++e) {
      if ((row == 0) != (system.column[e] == 0)) system.value[e] = 0;
    }
  }
}

TEST_F(ContactArraysOnDevice, TakeNewNumbersAndZeros) {
  ContactProblem problem = global_problem(51, 8, 0);
  ContactSolver host({.backend = Backend::cuda}), solver({.backend = Backend::cuda});
  solver.set_structure(problem);
  for (int step = 0; step < 4; ++step) {
    if (step == 1) {
      for (double& value : problem.load) value *= 1.25;
    }
    if (step == 2) uncouple_first_dof(problem.system);
    const ContactSolution wanted = host.solve(problem);
    const DeviceProblem device(problem);
    expect_results(device, solver.solve(device.arrays, device.target()), wanted,
                   "step " + std::to_string(step));
  }
}

TEST_F(ContactArraysOnDevice, OtherProblemsMayComeBetween) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 52, .edge = 4, .kept = 0.4});
  ContactSolver solver({.backend = Backend::cuda});
  solver.set_structure(problem);
  const DeviceProblem device(problem);
  const ContactReport first = solver.solve(device.arrays, device.target());
  const std::vector<double> impulse = device.impulse.get();

  solver.solve(local_problem(53, 20));

  EXPECT_EQ(solver.solve(device.arrays, device.target()).sweeps, first.sweeps);
  EXPECT_EQ(device.impulse.get(), impulse);
}

/// The message of the error that work() throws.
template <class Error, class Work>
std::string message_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(ContactArraysOnDevice, BadNumbersAreReportedAsFromHostMemory) {
  const ContactProblem good = sticky_packing(54, 3);
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<const char*, void (*)(ContactProblem&)>> faults = {
      {"friction", [](ContactProblem& p) { p.friction[1] = -1; }},
      {"load", [](ContactProblem& p) { p.load[2] = std::numeric_limits<double>::quiet_NaN(); }},
      {"intensity", [](ContactProblem& p) { p.adhesion.intensity[1] = 1.5; }},
      {"step", [](ContactProblem& p) { p.adhesion.time_step = 0; }},
      {"mass", [](ContactProblem& p) { p.system.value[0] = -p.system.value[0]; }},
      {"row", [](ContactProblem& p) {
         const auto last = static_cast<std::size_t>(p.jacobian.row_start[1]);
         for (std::size_t e = 0; e < last; ++e) p.jacobian.value[e] = 0;
       }}};
  for (const auto& [name, damage] : faults) {
    ContactProblem bad = good;
    damage(bad);
    ContactSolver solver({.backend = Backend::cuda});
    solver.set_structure(good);
    DeviceProblem device(bad);
    device.impulse.set(std::vector<double>(3 * good.friction.size(), infinity));
    const std::string wanted = message_of<ContactProblemError>([&] { check_problem(bad); });
    EXPECT_NE(wanted, "no error") << name;

    EXPECT_EQ(
        message_of<ContactProblemError>([&] { solver.solve(device.arrays, device.target()); }),
        wanted)
        << name;

    EXPECT_EQ(device.impulse.get()[0], infinity) << name << ": something was written";
  }
}

TEST_F(ContactArraysOnDevice, WrongMemoryIsNamed) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 55, .edge = 3, .kept = 0.4});
  const DeviceProblem device(problem);
  ContactSolver cpu({.backend = Backend::cpu}), solver({.backend = Backend::cuda});
  cpu.set_structure(problem);
  const auto message = [](ContactSolver& from, const ContactArrays& arrays,
                          const ContactTarget& target) {
    return message_of<std::invalid_argument>([&] { from.solve(arrays, target); });
  };
  EXPECT_NE(message(solver, device.arrays, device.target()).find("set_structure()"),
            std::string::npos);
  solver.set_structure(problem);

  EXPECT_EQ(message(cpu, device.arrays, device.target()),
            "arrays: device memory needs back end cuda");
  ContactArrays mixed = device.arrays;
  mixed.load = problem.load;
  EXPECT_EQ(message(solver, mixed, device.target()).find("load: not in memory of the device"), 0u);
  ContactTarget host_target = device.target();
  host_target.memory = Memory::host;
  EXPECT_EQ(message(solver, device.arrays, host_target),
            "target: its memory differs from that of the problem");
  ContactArrays shorter = device.arrays;
  shorter.friction = shorter.friction.first(shorter.friction.size() - 1);
  EXPECT_EQ(message(solver, shorter, device.target()).find("friction: "), 0u);
}

TEST_F(ContactArraysOnDevice, RunOnTheStreamOfTheCaller) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 56, .edge = 4, .kept = 0.4});
  ContactSolver solver({.backend = Backend::cuda});
  const ContactSolution wanted = solver.solve(problem);
  DeviceProblem device(problem);
  DeviceArray load(problem.load.size());  // written by the caller's stream, or the default one
  device.arrays.load = load.span();
  solver.set_structure(problem);
  {
    const DeviceStream own;
    for (const cudaStream_t stream : {cudaStream_t{own}, cudaStream_t{nullptr}}) {
      load.set(std::vector<double>(problem.load.size(), 0.0));
      cudaMemcpyAsync(load.data(), problem.load.data(), problem.load.size() * sizeof(double),
                      cudaMemcpyHostToDevice, stream);
      expect_results(device, solver.solve(device.arrays, device.target(stream)), wanted, "stream");
    }
  }
  EXPECT_EQ(solver.solve(problem).impulse, wanted.impulse);  // the caller's stream is gone
}

}  // namespace tetwarp::test
