/// @file test_contact_arrays_emulated.cpp
/// Contact problems in memory of the emulated device: results, and what is copied.
#include "tests/device/contact_arrays_adhesion.hpp"
#include "tests/emulated/device_calls.hpp"

namespace tetwarp::test {
namespace {
struct Copied : simt::CopiedBytes {
  DeviceCalls calls;
};

Copied copied_by(ContactSolver& solver, const DeviceProblem& problem) {
  simt::Device& device = simt::Device::only();
  device.take_copied();
  take_calls();
  solver.solve(problem.arrays, problem.target());
  return {device.take_copied(), take_calls()};
}

/// Of the second solve of a problem, which needs no memory.
Copied copied_again(const ContactProblem& problem) {
  ContactOptions options{.tolerance = 1e-3, .backend = Backend::cuda};
  options.expert.skip.converged_islands = false;
  ContactSolver solver(options);
  solver.set_structure(problem);
  const DeviceProblem device(problem);
  copied_by(solver, device);

  Copied again = copied_by(solver, device);
  EXPECT_EQ(again.calls.count(DeviceCall::allocate), 0);
  EXPECT_LE(again.calls.count(DeviceCall::copy_to_device), 1);
  return again;
}

/// One island each, so that what is copied per island does not grow.
TEST(ContactArraysEmulated, ASolveCopiesCountsAndNoArray) {
  const Copied small = copied_again(scenes::sphere_packing({.seed = 62, .edge = 4}));
  const Copied large = copied_again(scenes::sphere_packing({.seed = 62, .edge = 6}));
  EXPECT_LT(small.to_host, 2000u) << small.calls;
  EXPECT_LT(small.to_device, 400u) << small.calls;
  EXPECT_LE(small.calls.count(DeviceCall::copy_to_host), 8);
  EXPECT_EQ(large.to_host, small.to_host);
  EXPECT_EQ(large.to_device, small.to_device);
}

/// An island that a grid solves needs no list of islands; each method reads its end by itself.
TEST(ContactArraysEmulated, ASolveByAGridCopiesCountsAndNoArray) {
  for (const std::int64_t contacts : {1000, 2000}) {
    const Copied again =
        copied_again(scenes::random_local({.seed = 61, .contacts = contacts, .neighbors = 2}));
    EXPECT_LT(again.to_host, 400u) << again.calls;
    EXPECT_EQ(again.to_device, 0u) << again.calls;
    EXPECT_LE(again.calls.count(DeviceCall::copy_to_host), 10);
  }
}

/// Which numbers of a block of A are zero does not matter where the problem names its blocks: only
/// zeros outside of them say what A couples.
TEST(ContactArraysEmulated, ZerosWithinBlocksChangeNothing) {
  ContactProblem problem = global_problem(64, 9, 0);
  ContactSolver host({.backend = Backend::cuda}), solver({.backend = Backend::cuda});
  solver.set_structure(problem);
  copied_by(solver, DeviceProblem(problem));
  uncouple_first_dof(problem.system);
  const DeviceProblem device(problem);

  const Copied copied = copied_by(solver, device);

  EXPECT_LE(copied.calls.count(DeviceCall::copy_to_host), 8);
  EXPECT_LE(copied.calls.count(DeviceCall::copy_to_device), 1);
  EXPECT_EQ(device.impulse.get(), host.solve(problem).impulse);
}

/// Where the device stops the host goes on, which sends back results and no numbers of the problem.
TEST(ContactArraysEmulated, IslandsThatDoNotConvergeAreNotSentAgain) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 65, .edge = 4, .kept = 0.4});
  ContactOptions options{.tolerance = 1e-13, .max_sweeps = 40, .backend = Backend::cuda};
  options.expert.skip.converged_islands = false;
  ContactSolver solver(options);
  solver.set_structure(problem);
  const DeviceProblem device(problem);
  copied_by(solver, device);

  const Copied again = copied_by(solver, device);

  const std::size_t results = 6 * problem.friction.size() + problem.load.size();
  EXPECT_LE(again.to_device, results * sizeof(double) + 400);
}

/// A large island is swept stage by stage, so that its solve can be ended.
TEST(ContactArraysEmulated, ProgressEndsASolve) {
  const ContactProblem problem =
      scenes::random_local({.seed = 46, .contacts = 2100, .neighbors = 2});
  int left = 5;
  ContactOptions options{.tolerance = 1e-12, .backend = Backend::cuda};
  options.expert.skip.converged_islands = false;
  options.progress = [&](const ContactProgress&) { return left-- > 0; };
  ContactSolver solver(options);
  solver.set_structure(problem);
  const DeviceProblem device(problem);

  const ContactReport report = solver.solve(device.arrays, device.target());

  EXPECT_EQ(report.status, ContactStatus::not_converged);
  EXPECT_NE(report.status_reason.find("cancelled"), std::string::npos) << report.status_reason;
}

TEST(ContactArraysEmulated, AFailedAllocationLeavesTheSolverUsable) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 62, .edge = 3, .kept = 0.4});
  const DeviceProblem device(problem);
  ContactSolver host({.backend = Backend::cuda});
  const ContactSolution wanted = host.solve(problem);
  ContactSolver solver({.backend = Backend::cuda});
  solver.set_structure(problem);
  int failed = 0;
  for (bool is_done = false; !is_done;) {
    simt::Device::only().failing_allocation = failed;
    try {
      expect_results(device, solver.solve(device.arrays, device.target()), wanted,
                     std::to_string(failed));
      is_done = true;
    } catch (const CudaError&) {
      ++failed;
    }
  }
  simt::Device::only().failing_allocation = simt::Device::none;
  EXPECT_GT(failed, 3);
  expect_results(device, solver.solve(device.arrays, device.target()), wanted, "after all");
}
}  // namespace

/// Host memory works the same on every back end.
TEST(ContactArrays, HostArraysGiveTheBitsOfAProblem) {
  const ContactProblem problem = sticky_packing(63, 3);
  for (const Backend backend : {Backend::cpu, Backend::cuda, Backend::reference}) {
    ContactSolver host({.backend = backend}), solver({.backend = backend});
    const ContactSolution wanted = host.solve(problem);
    solver.set_structure(problem);
    std::vector<double> impulse(wanted.impulse.size()), velocity(wanted.velocity.size());

    ContactTarget target;
    target.impulse = impulse;
    target.velocity = velocity;
    const ContactReport report = solver.solve(arrays_of(problem), target);

    EXPECT_EQ(impulse, wanted.impulse);
    EXPECT_EQ(velocity, wanted.velocity);
    EXPECT_EQ(report.sweeps, wanted.report.sweeps);
  }
}
}  // namespace tetwarp::test
