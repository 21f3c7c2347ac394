/// @file mixed_contacts.hpp
/// A scene of all kinds of bodies with random contacts, and one step of it.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "tests/simulate/hand_contacts.hpp"

namespace tetwarp::test {

constexpr double mixed_step = 5e-3;  // [s]

/// An elastic block with held nodes and a coupling, a second one, cloth, rigid bodies and a moving
/// frame, with random contacts between all of them; the last block touches nothing.
HandScene mixed_scene(unsigned seed, double adhesion_area = 0);

/// Boxes of half edges 0.1, 0.1, 0.05 m and 1 kg one on the other, the first on a frame; each
/// touches what it stands on at its four corners.
HandScene stack_on_frame(std::int32_t count);

/// All contacts are near; with a stiffness they are bonded.
ContactTrackerOptions materials(double friction, double stiffness = 0);

/// One thread and a small tolerance.
ContactSystemOptions exact(Backend backend = Backend::cpu);

/// One step without its end.
struct Solved {
  std::unique_ptr<BodyStepper> stepper;
  std::vector<Point3> free, velocity, impulses;
  std::vector<TrackedContact> contacts;
  ContactSolution solution;
  ContactSolveOutcome outcome;
};

/// @param gap  of all contacts; nothing: as the points have it
Solved solve(const HandScene& scene,
             const ContactTrackerOptions& tracking,
             const ContactSystemOptions& options,
             std::optional<double> gap = 0.0,
             int threads = 1);

}  // namespace tetwarp::test
