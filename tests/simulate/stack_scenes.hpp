/// @file stack_scenes.hpp
/// Stacks of elastic bodies and two rods whose contacts are given by hand.
#pragma once
#include <cstdint>

#include "tests/simulate/hand_contacts.hpp"

namespace tetwarp::test {

constexpr double stack_step = 8e-3;  // [s]

/// A stiff elastic block on a frame and a rigid box on it, all touching at many points.
HandScene stack_scene(double youngs);

/// Two elastic blocks side by side on a frame, tied to each other by springs.
/// @param spring  stiffness of each [N/m]
HandScene tied_scene(double youngs, double spring);

/// A stiff sheet on a frame, all nodes touching, and a rigid box on some of them.
/// @param stiffness  of its edges [N/m]
/// @param cells      along each side
HandScene sheet_scene(double stiffness, std::int32_t cells = 6);

/// Three elastic blocks on a frame. With 12 cells along each side there are groups of 169, 57 and
/// 85 contacts of one body or of two.
/// @param height  of the shape at the start, as a factor of that at rest
/// @param cells   of each block along x and y
HandScene tower_scene(double height = 1, std::int32_t cells = 12);

/// The rods of `missed_contacts` of 0.1 kg beside each other, joined by a spring, and a frame that
/// holds them against a push along -x.
HandScene rods_scene();

}  // namespace tetwarp::test
