/// @file view_tools.hpp
/// Bodies that options add to a scene, for the mouse to carry.
#pragma once
#include <tetwarp/scene.hpp>

#include "host/view/view_options.hpp"

namespace tetwarp::view {

inline constexpr const char* outer_finger = "finger_outside";
inline constexpr const char* inner_finger = "finger_inside";

/// The ball to push with; the fingers, of which the outer one touches nothing.
void add_tools(const ViewOptions& options, Scene& scene);

}  // namespace tetwarp::view
