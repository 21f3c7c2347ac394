/// @file contact_arrays_adhesion.hpp
/// Adhesion whose arrays are in memory of a device, for tests on the emulated device and on a real
/// one.
#pragma once
#include <cmath>

#include "tests/device/contact_arrays.hpp"

namespace tetwarp::test {

/// In place, as a simulation would; with a normal gap that is dt w_n, and with another one. A
/// device may fuse gap + dt v, which saves the rounding of the product.
TEST_F(ContactArraysOnDevice, EvolveAsInHostMemory) {
  for (const double shift : {0.0, 1e-6}) {
    ContactProblem problem = sticky_packing(57, 4);
    AdhesionState& adhesion = problem.adhesion;
    const std::size_t contacts = problem.friction.size();
    adhesion.energy.assign(contacts, 0.01);
    adhesion.viscosity.assign(contacts, 1e-3);
    adhesion.bonding_rate.assign(contacts, 1e-3);
    adhesion.saturation_pressure.assign(contacts, 1e3);
    for (std::size_t c = 0; c < contacts; c += 2) adhesion.gap[3 * c] += shift;
    ContactSolver solver({.backend = Backend::cuda});
    const ContactSolution solution = solver.solve(problem);
    const AdhesionStep wanted = solver.evolve(problem, solution);
    EXPECT_NE(wanted.intensity, adhesion.intensity);

    DeviceProblem device(problem);
    device.impulse.set(solution.impulse);
    device.velocity.set(solution.velocity);
    const DeviceArray energy(adhesion.energy), viscosity(adhesion.viscosity),
        rate(adhesion.bonding_rate), pressure(adhesion.saturation_pressure),
        intensity(adhesion.intensity), gap(adhesion.gap);
    device.arrays.intensity = intensity.span();
    device.arrays.gap = gap.span();
    AdhesionArrays arrays{energy.span(),      viscosity.span(), rate.span(), pressure.span(),
                          intensity.target(), gap.target(),     {}};
    solver.evolve(device.arrays, device.target(), arrays);

    const std::vector<double> found = intensity.get(), moved = gap.get();
    for (std::size_t c = 0; c < contacts; ++c) {
      EXPECT_NEAR(found[c], wanted.intensity[c], shift == 0 ? 0 : 1e-9) << c;
      for (std::size_t k = 0; k < 3; ++k) {
        const double to = wanted.gap[3 * c + k], from = adhesion.gap[3 * c + k];
        const double product_rounding = 0x1p-52 * (std::abs(to) + std::abs(from));
        EXPECT_NEAR(moved[3 * c + k], to, shift == 0 ? product_rounding : 1e-15) << c;
      }
    }
    arrays.energy = adhesion.energy;
    EXPECT_EQ(message_of<std::invalid_argument>(
                  [&] { solver.evolve(device.arrays, device.target(), arrays); }),
              "adhesion.energy: not in memory of the device of this solver");
  }
}

}  // namespace tetwarp::test
