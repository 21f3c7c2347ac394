/// @file contact_sides.hpp
/// The nodes and frames that the two points of contacts move with.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/simulate/surfaces/scene_surfaces.hpp"
#include "kernels/body/contact_arms.hpp"

namespace tetwarp {

/// Frame of the model of each body and obstacle that has one, else -1.
std::vector<std::int32_t> frames_of_bodies(const SceneSurfaces& scene, const Model& model);

/// A point x of a rigid body moves with v + omega x (x - center), a point of a deformable body with
/// the weighted mean of up to 12 nodes.
/// @param frames   of frames_of_bodies()
/// @param threads  any number: same sides
/// @param sides    out, [contacts]; memory is kept
void set_contact_sides(const SceneSurfaces& scene,
                       std::span<const std::int32_t> frames,
                       std::span<const TrackedContact> contacts,
                       int threads,
                       std::vector<ContactSides>& sides);

}  // namespace tetwarp
