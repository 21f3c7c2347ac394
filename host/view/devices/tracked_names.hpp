/// @file tracked_names.hpp
/// TrackedNames: which sensor of which tracker, with which buttons.
#pragma once
#include <string>

namespace tetwarp::view {

struct TrackedNames {
  std::string tracker, buttons;  ///< NAME@HOST or NAME@HOST:PORT
  int sensor = 0;
};

/// Hosts are names or IPv4 addresses: what else VRPN takes for one may start programs or read
/// files.
/// @param name  TRACKER@HOST[:PORT][#SENSOR][+BUTTONS@HOST[:PORT]]: sensor 0, and buttons and axes
///              of the tracker's own name, where nothing else is said
/// @throws std::invalid_argument  the name is none
TrackedNames tracked_names(const std::string& name);

}  // namespace tetwarp::view
