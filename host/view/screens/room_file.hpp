/// @file room_file.hpp
/// Rooms as JSON files, and those that ship with the program.
#pragma once
#include <string>
#include <vector>

#include "host/view/screens/room.hpp"

namespace tetwarp::view {

/// Reads a room and checks it by check_room(). docs/screens.md explains the keys.
/// @param name  in messages in place of a file
/// @throws IoError  in one line: name, key and problem
Room parse_room(const std::string& text, const std::string& name);

/// Names of the rooms that ship with the program.
std::vector<std::string> room_names();
/// The text of a room that ships, for parse_room(). @throws std::invalid_argument no such room
std::string room_text(const std::string& name);

}  // namespace tetwarp::view
