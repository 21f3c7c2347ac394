/// @file sockets.hpp
/// What the sockets of master and screens have in common.
#pragma once
#include <span>
#include <string>
#include <zmq.hpp>

#include "host/view/screens/message_bytes.hpp"
#include "host/view/screens/screen_keys.hpp"

namespace tetwarp::view {

/// Notices peers that are gone without a word, and does not wait for them at the end.
void set_up_socket(zmq::socket_t& socket);

inline std::span<const std::byte> bytes_of(const zmq::message_t& message) {
  return {static_cast<const std::byte*>(message.data()), message.size()};
}

/// New key pairs. @throws std::runtime_error  this ZeroMQ has no CURVE
ScreenKeys make_screen_keys();

}  // namespace tetwarp::view
