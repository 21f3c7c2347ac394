/// @file stack_steps.hpp
/// Steps of scenes with contacts by hand, and their residuals by a factorization of A.
#pragma once
#include <cstddef>
#include <vector>

#include <tetwarp/contact.hpp>

#include "tests/simulate/stack_scenes.hpp"

namespace tetwarp::test {

struct StackStep {
  ContactSolveOutcome outcome;
  ContactResidual residual;  ///< by a factorization of A
  std::vector<Point3> velocity;
};

/// Steps of a scene that is pushed sideways; the velocities of the stepper are those of the
/// solution, bit for bit.
/// @param options   with back end cuda bodies are stepped on the device, too
/// @param adhesion  stiffness of bonds [N/m^3], or 0
/// @param change    null: each step starts from the velocities without contact
std::vector<StackStep> run_stack(const HandScene& scene,
                                 const ContactSystemOptions& options,
                                 double adhesion,
                                 std::vector<Point3>* change,
                                 double friction = 0.4,
                                 std::size_t count = 4);

}  // namespace tetwarp::test
