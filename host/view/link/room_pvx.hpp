/// @file room_pvx.hpp
/// Rooms as ParaView's CAVE files.
#pragma once
#include <string>

#include "host/view/screens/room.hpp"

namespace tetwarp::view {

/// Reads a file of ParaView's CAVE displays (.pvx): a screen for each Machine, by its corners,
/// window, display and kind of stereo. Places are meters, the observer is at the origin. Keys
/// without effect here are listed in Room::notes.
/// @param name  of the file, for messages
/// @throws IoError  in one line: name, line and problem
Room parse_pvx(const std::string& text, const std::string& name);

}  // namespace tetwarp::view
