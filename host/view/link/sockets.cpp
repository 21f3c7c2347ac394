/// @file sockets.cpp
/// Options of sockets and keys.
#include "host/view/link/sockets.hpp"

#include <stdexcept>

namespace tetwarp::view {
namespace {
constexpr int heartbeat = 1000, heartbeat_timeout = 3000, linger = 200;  // [ms]

void make_pair(std::string& open, std::string& secret) {
  char letters[2][41];
  if (zmq_curve_keypair(letters[0], letters[1]) != 0) {
    throw std::runtime_error("the ZeroMQ of this system makes no keys: it lacks CURVE");
  }
  open = letters[0];
  secret = letters[1];
}
}  // namespace

void set_up_socket(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::linger, linger);
  socket.set(zmq::sockopt::heartbeat_ivl, heartbeat);
  socket.set(zmq::sockopt::heartbeat_timeout, heartbeat_timeout);
}

ScreenKeys make_screen_keys() {
  ScreenKeys keys;
  make_pair(keys.master_public, keys.master_secret);
  make_pair(keys.screen_public, keys.screen_secret);
  return keys;
}

}  // namespace tetwarp::view
