/// @file screen_link.hpp
/// ScreenLink: the end of a screen or a tracker in its talk with the master.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <zmq.hpp>

#include "host/base/stopwatch.hpp"
#include "host/view/screens/screen_keys.hpp"
#include "host/view/screens/screen_message.hpp"

namespace tetwarp::view {

/// Of one thread. Connects by itself, again and again, also to a master that starts later.
class ScreenLink {
 public:
  /// @param keys  of the screens, or none
  /// @throws std::runtime_error  the address is none
  ScreenLink(const std::string& address, const ScreenKeys& keys);

  /// Waits for the connection, for what must not be lost.
  /// @returns whether there is one before `seconds` are over
  bool wait_for_master(double seconds);
  /// The next message of the master; malformed ones are counted and left out. In between it says
  /// that this process is alive.
  /// @param seconds  how long to wait at most; a signal ends it
  std::optional<ToScreen> receive(double seconds);
  /// Never waits; without a master the message is lost.
  void send(const ToMaster& message);

  std::int64_t malformed_count() const { return malformed_count_; }

 private:
  std::optional<ToScreen> wait_for_message(double seconds);

  zmq::context_t context_;
  zmq::socket_t socket_;
  Stopwatch since_sent_;
  std::int64_t malformed_count_ = 0;
};

}  // namespace tetwarp::view
