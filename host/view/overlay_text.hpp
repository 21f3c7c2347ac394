/// @file overlay_text.hpp
/// What the corner of the window says.
#pragma once
#include <cstddef>
#include <string>

#include "host/view/live_frame.hpp"
#include "host/view/view_scene.hpp"

namespace tetwarp::view {

/// @param pictures  drawn in the last second
std::string overlay_text(const ViewScene& scene, const LiveFrame& frame, std::size_t pictures);

/// What is under the pointer: body, place, and the value of its volume a voxel below the surface.
/// @param ray  from the eye
std::string probe_text(const ViewScene& scene,
                       const LiveFrame& frame,
                       const Pick& found,
                       const Point3& ray);

}  // namespace tetwarp::view
