/// @file grab_handle.hpp
/// The handle by which the mouse or a device holds a body.
#pragma once
#include <cstddef>

#include <tetwarp/simulate.hpp>

#include "host/view/view_options.hpp"

namespace tetwarp::view {

/// With radius and stiffness of the options, or those that suit the body.
/// @param point  of its surface [world]
PointHandle grab_handle(const Simulator& simulator,
                        const ViewOptions& options,
                        std::size_t body,
                        const Point3& point);

}  // namespace tetwarp::view
