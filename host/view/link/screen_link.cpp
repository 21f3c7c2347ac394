/// @file screen_link.cpp
/// A DEALER.
#include "host/view/link/screen_link.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <stdexcept>

#include "host/view/link/sockets.hpp"

namespace tetwarp::view {
namespace {
constexpr double alive_seconds = 0.5;
constexpr int first_reconnect = 50, last_reconnect = 500;  // [ms]
}  // namespace

ScreenLink::ScreenLink(const std::string& address, const ScreenKeys& keys)
    : socket_(context_, zmq::socket_type::dealer) {
  set_up_socket(socket_);
  socket_.set(zmq::sockopt::immediate, 1);
  socket_.set(zmq::sockopt::reconnect_ivl, first_reconnect);
  socket_.set(zmq::sockopt::reconnect_ivl_max, last_reconnect);
  if (keys.are_given()) {
    socket_.set(zmq::sockopt::curve_serverkey, keys.master_public);
    socket_.set(zmq::sockopt::curve_publickey, keys.screen_public);
    socket_.set(zmq::sockopt::curve_secretkey, keys.screen_secret);
  }
  try {
    socket_.connect(address);
  } catch (const zmq::error_t& error) {
    throw std::runtime_error("address '" + address + "': " + error.what() +
                             "; expected tcp://HOST:PORT");
  }
}

bool ScreenLink::wait_for_master(double seconds) {
  const auto wait = std::chrono::duration<double>(seconds);
  zmq::pollitem_t item{socket_.handle(), 0, ZMQ_POLLOUT, 0};
  return zmq::poll(&item, 1, std::chrono::ceil<std::chrono::milliseconds>(wait)) > 0;
}

std::optional<ToScreen> ScreenLink::receive(double seconds) {
  try {
    return wait_for_message(seconds);
  } catch (const zmq::error_t& error) {
    if (error.num() == EINTR) return std::nullopt;  // a signal
    throw;
  }
}

std::optional<ToScreen> ScreenLink::wait_for_message(double seconds) {
  const Stopwatch watch;
  while (true) {
    if (since_sent_.seconds() >= alive_seconds) send(AliveMessage{});
    const double left = std::max(seconds - watch.seconds(), 0.0);
    zmq::pollitem_t item{socket_.handle(), 0, ZMQ_POLLIN, 0};
    const auto wait = std::chrono::duration<double>(std::min(left, alive_seconds));
    zmq::poll(&item, 1, std::chrono::ceil<std::chrono::milliseconds>(wait));
    zmq::message_t message;
    if (!socket_.recv(message, zmq::recv_flags::dontwait)) {
      if (watch.seconds() >= seconds) return std::nullopt;
      continue;
    }
    try {
      return to_screen(bytes_of(message));
    } catch (const std::invalid_argument&) {
      ++malformed_count_;
    }
  }
}

void ScreenLink::send(const ToMaster& message) {
  const Bytes bytes = bytes_of(message);
  socket_.send(zmq::buffer(bytes), zmq::send_flags::dontwait);
  since_sent_ = Stopwatch();
}

}  // namespace tetwarp::view
