/// @file contact_transforms.hpp
/// Transforms of a contact problem that leave its solution the same: other orders, a mirror image,
/// other units.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp::test {

/// A problem in global form with blocks, and any impulses and velocities, solution or not.
struct ContactCase {
  ContactProblem problem;
  std::vector<double> impulse;
  std::vector<double> body_velocity;
};

/// Contacts and bodies in another, random order.
ContactCase permuted(const ContactCase& original, std::uint64_t seed);

/// Mirrored across x: the x of vectors and the y and z of spins change sign; frames stay
/// right-handed, so tangent 2 is turned round.
/// @pre every block is a rigid body: velocity, then spin
ContactCase mirrored(const ContactCase& original);

/// Units of mass, length and time that many times smaller, so that numbers are larger.
/// @pre every block is a rigid body
ContactCase rescaled(const ContactCase& original, double mass, double length, double time);

}  // namespace tetwarp::test
