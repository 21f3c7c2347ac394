/// @file head_sender.hpp
/// Poses of the head, from lines of text or a tracker, for a master.
#pragma once
#include <csignal>
#include <istream>
#include <string>

#include "host/view/link/screen_link.hpp"

namespace tetwarp::view {

/// Sends lines x y z or x y z qw qx qy qz until they end.
/// @throws std::runtime_error  naming the line that is none
void send_head_lines(std::istream& lines, ScreenLink& link);

/// Sends the poses of a tracker until a signal ends it, and prints when there are some and why
/// there are none.
/// @param name  as open_tracked_device()
void send_tracked_head(const std::string& name,
                       ScreenLink& link,
                       const volatile std::sig_atomic_t& is_interrupted);

}  // namespace tetwarp::view
