/// @file test_contact_arrays_device.cu
/// Contact problems in memory of a real device; skipped without one.
#include "tests/device/contact_arrays_adhesion.hpp"

namespace tetwarp::test {

TEST_F(ContactArraysOnDevice, ASolverGoesOnAfterTheDeviceWasOutOfMemory) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 71, .edge = 4, .kept = 0.4});
  ContactSolver solver({.backend = Backend::cuda});
  const ContactSolution wanted = solver.solve(problem);
  std::size_t free = 0, total = 0;
  ASSERT_EQ(cudaMemGetInfo(&free, &total), cudaSuccess);
  void* most = nullptr;
  EXPECT_EQ(cudaMalloc(&most, total + 1), cudaErrorMemoryAllocation);  // its error stays behind

  const DeviceProblem device(problem);
  solver.set_structure(problem);

  expect_results(device, solver.solve(device.arrays, device.target()), wanted, "after an error");
}

}  // namespace tetwarp::test
