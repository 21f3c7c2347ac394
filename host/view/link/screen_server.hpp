/// @file screen_server.hpp
/// ScreenServer: the master's end of the talk with screens, in a thread of its own.
#pragma once
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <zmq.hpp>

#include "host/base/stopwatch.hpp"
#include "host/view/screens/room.hpp"
#include "host/view/screens/screen_keys.hpp"
#include "host/view/screens/screen_message.hpp"
#include "host/view/screens/swap_group.hpp"

namespace tetwarp::view {

/// How the screens are doing.
struct ScreenCounts {
  std::int64_t screens = 0;       ///< that take part now
  std::int64_t frames = 0;        ///< sent in all
  std::int64_t frame_bytes = 0;   ///< of the last frame, for one screen
  std::int64_t ready_frames = 0;  ///< that all screens had drawn in time
  double ready_seconds = 0;       ///< from sending them until all had, in all
  std::int64_t late = 0;          ///< frames that a screen had not drawn in time
  std::int64_t lost = 0;          ///< screens that fell silent
  std::int64_t malformed = 0;     ///< messages that were ignored
  bool has_lost_head = false;     ///< a tracker has spoken, and is silent now
};

class ScreenServer {
 public:
  /// Listens from now on.
  /// @param room   checked
  /// @param scene  bytes of a SharedScene
  /// @param keys   of the master; without them any process of this machine may join
  /// @throws std::runtime_error  the address cannot be listened at, or needs keys
  ScreenServer(Room room, Bytes scene, ScreenKeys keys);
  ScreenServer(const ScreenServer&) = delete;
  ScreenServer& operator=(const ScreenServer&) = delete;
  ~ScreenServer();  ///< the screens show the newest state, then hear that the master ends

  /// From any thread; neither waits. Of successive ones the newest is sent.
  void set_state(Bytes state);
  void set_view(const RoomPlace& place, const ScreenLook& look);

  /// The address that it listens at; where the room has port *, with the port that was chosen.
  const std::string& address() const { return address_; }
  ScreenCounts counts() const;

 private:
  void listen();
  void start();
  void run();
  bool has_work() const;
  void wait_for_work();
  void receive_all();
  void receive(const std::string& member, const ToMaster& message);
  void welcome(const std::string& member, const JoinMessage& message);
  void check_peers();
  void swap();
  void find_gone();
  void send_frame();
  void send(const std::string& member, const ToScreen& message);
  void send(const std::string& member, const Bytes& bytes);
  void wake();

  const Room room_;
  const Bytes scene_;
  const ScreenKeys keys_;
  const std::uint64_t session_;
  std::string address_;
  zmq::context_t context_;
  zmq::socket_t socket_, gate_;  ///< of messages; of ZeroMQ's requests to authenticate peers
  int wake_;                     ///< a file that becomes readable
  Stopwatch clock_;

  // of the thread
  SwapGroup group_;
  std::optional<HeadPose> tracked_;
  double heard_head_ = 0;  ///< when [s]
  std::uint64_t frame_ = 0;
  double sent_ = 0;           ///< when the last frame was [s]
  double asked_ = 0;          ///< when find_gone() was [s]
  Stopwatch drawing_;         ///< since the last frame was sent
  std::int64_t gone_ = 0;     ///< members that fell silent or whose connection ended
  bool needs_frame_ = false;  ///< something changed since then

  mutable std::mutex mutex_;  ///< guards the members up to the next comment
  Bytes state_;
  RoomPlace place_;
  ScreenLook look_;
  bool has_view_ = false, is_fresh_ = false;
  ScreenCounts counts_;

  std::atomic<bool> is_ending_{false};
  std::thread thread_;
};

}  // namespace tetwarp::view
