/// @file check_motion.hpp
/// Checks of paths, motions and selections.
#pragma once
#include <string>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// @param may_release  whether the last point may let go
void check_path(const std::string& place, const Path& path, bool may_release);
void check_motion(const std::string& place, const Motion& motion);

/// @param body  that the selection belongs to
void check_selection(const std::string& place, const Selection& select, const Body& body);

}  // namespace tetwarp
