/// @file screen_server.cpp
/// A ROUTER socket, which addresses each screen by its routing id, and the thread that serves it.
#include "host/view/link/screen_server.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <random>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>
#include <zmq_addon.hpp>

#include "host/view/link/sockets.hpp"

namespace tetwarp::view {
namespace {
constexpr double silent_seconds = 2, repeat_seconds = 0.5, track_seconds = 0.01;
constexpr std::int64_t most_bytes = 1 << 20;  // of a message to the master
constexpr std::size_t key_bytes = 32;

std::uint64_t random_session() {
  std::random_device random;
  return (std::uint64_t{random()} << 32 | random()) | 1;
}
}  // namespace

ScreenServer::ScreenServer(Room room, Bytes scene, ScreenKeys keys)
    : room_(std::move(room)),
      scene_(std::move(scene)),
      keys_(std::move(keys)),
      session_(random_session()),
      socket_(context_, zmq::socket_type::router),
      gate_(context_, zmq::socket_type::rep),
      wake_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      group_(room_.wait, silent_seconds) {
  if (wake_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  listen();
  start();
}

/// Signals are for the main thread.
void ScreenServer::start() {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { run(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

ScreenServer::~ScreenServer() {
  is_ending_ = true;
  wake();
  thread_.join();
  close(wake_);
}

void ScreenServer::listen() {
  if (!keys_.are_given() && !is_loopback(room_.address)) {
    throw std::runtime_error(
        "address '" + room_.address +
        "': other machines may join only with a key; make one by tetwarp view --make-keys NAME and "
        "give --key NAME.key");
  }
  set_up_socket(socket_);
  socket_.set(zmq::sockopt::router_mandatory, 1);  // says that a peer is gone
  socket_.set(zmq::sockopt::maxmsgsize, most_bytes);
  if (keys_.are_given()) {
    gate_.bind("inproc://zeromq.zap.01");
    socket_.set(zmq::sockopt::curve_server, 1);
    socket_.set(zmq::sockopt::curve_secretkey, keys_.master_secret);
  }
  try {
    socket_.bind(room_.address);
  } catch (const zmq::error_t& error) {
    throw std::runtime_error("address '" + room_.address + "': " + error.what() +
                             "; expected tcp://INTERFACE:PORT with a free port");
  }
  address_ = socket_.get(zmq::sockopt::last_endpoint);
}

void ScreenServer::wake() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(wake_, &one, sizeof one);
}

void ScreenServer::set_state(Bytes state) {
  {
    const std::lock_guard lock(mutex_);
    state_ = std::move(state);
    is_fresh_ = true;
  }
  wake();
}

void ScreenServer::set_view(const RoomPlace& place, const ScreenLook& look) {
  {
    const std::lock_guard lock(mutex_);
    if (has_view_ && place == place_ && look == look_) return;
    place_ = place;
    look_ = look;
    has_view_ = is_fresh_ = true;
  }
  wake();
}

ScreenCounts ScreenServer::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

/// Whether a screen has not shown the newest state yet.
bool ScreenServer::has_work() const {
  const std::lock_guard lock(mutex_);
  return group_.size() > 0 && (is_fresh_ || needs_frame_ || group_.is_drawing());
}

void ScreenServer::run() {
  std::optional<double> ending;
  while (true) {
    if (is_ending_ && !ending) ending = clock_.seconds();
    if (ending && (!has_work() || clock_.seconds() > *ending + silent_seconds)) break;
    wait_for_work();
    check_peers();
    receive_all();
    swap();
    send_frame();
    find_gone();
    if (!ending) gone_ += static_cast<std::int64_t>(group_.drop_silent(clock_.seconds()).size());
    const std::lock_guard lock(mutex_);
    counts_.lost = gone_;
    counts_.screens = static_cast<std::int64_t>(group_.size());
    counts_.late = group_.late_count();
    counts_.has_lost_head =
        (tracked_ || !room_.tracker.empty()) && clock_.seconds() - heard_head_ > silent_seconds;
  }
  for (const std::string& member : group_.members()) send(member, EndMessage{});
}

void ScreenServer::wait_for_work() {
  const double now = clock_.seconds();
  double wait = room_.head_path.empty() ? repeat_seconds : track_seconds;
  if (group_.is_drawing()) wait = std::min(wait, group_.latest_swap() - now);
  zmq::pollitem_t items[] = {{socket_.handle(), 0, ZMQ_POLLIN, 0},
                             {nullptr, wake_, ZMQ_POLLIN, 0},
                             {gate_.handle(), 0, ZMQ_POLLIN, 0}};
  const auto most = std::chrono::duration<double>(std::max(wait, 0.0));
  zmq::poll(items, keys_.are_given() ? 3 : 2, std::chrono::ceil<std::chrono::milliseconds>(most));
  std::uint64_t count = 0;
  [[maybe_unused]] const auto taken = read(wake_, &count, sizeof count);
}

/// Answers requests of ZeroMQ's authentication protocol (ZAP, rfc.zeromq.org/spec/27): a peer may
/// connect if its public key is that of the screens.
void ScreenServer::check_peers() {
  if (!keys_.are_given()) return;
  std::uint8_t known[key_bytes]{};
  const bool is_known = zmq_z85_decode(known, keys_.screen_public.c_str()) != nullptr;
  while (true) {
    std::vector<zmq::message_t> parts;
    if (!zmq::recv_multipart(gate_, std::back_inserter(parts), zmq::recv_flags::dontwait)) return;
    const bool is_welcome = is_known && parts.size() == 7 && parts[5].to_string_view() == "CURVE" &&
                            parts[6].size() == key_bytes &&
                            std::equal(known, known + key_bytes, parts[6].data<std::uint8_t>());
    const std::string id = parts.size() > 1 ? parts[1].to_string() : "";
    const std::string answer[] = {"1.0", id, is_welcome ? "200" : "400", "", "", ""};
    for (std::size_t n = 0; n < std::size(answer); ++n) {
      const bool is_last = n + 1 == std::size(answer);
      gate_.send(zmq::buffer(answer[n]),
                 is_last ? zmq::send_flags::none : zmq::send_flags::sndmore);
    }
  }
}

void ScreenServer::receive_all() {
  while (true) {
    std::vector<zmq::message_t> parts;
    if (!zmq::recv_multipart(socket_, std::back_inserter(parts), zmq::recv_flags::dontwait)) return;
    try {
      if (parts.size() != 2) throw std::invalid_argument("not one part");
      receive(parts[0].to_string(), to_master(bytes_of(parts[1])));
    } catch (const std::invalid_argument&) {
      const std::lock_guard lock(mutex_);
      ++counts_.malformed;
    }
  }
}

void ScreenServer::receive(const std::string& member, const ToMaster& message) {
  if (const auto* const join = std::get_if<JoinMessage>(&message)) return welcome(member, *join);
  if (const auto* const head = std::get_if<HeadMessage>(&message)) {
    tracked_ = head->head;
    heard_head_ = clock_.seconds();
    needs_frame_ = true;
  } else if (std::holds_alternative<LeaveMessage>(message)) {
    group_.leave(member);
  } else if (!group_.hear(member, clock_.seconds())) {
    send(member, WhoMessage{});
  } else if (const auto* const ready = std::get_if<ReadyMessage>(&message)) {
    const bool shows_now = group_.ready(member, ready->frame, clock_.seconds());
    if (shows_now) send(member, SwapMessage{ready->frame});
  }
}

void ScreenServer::welcome(const std::string& member, const JoinMessage& message) {
  const auto screen = std::ranges::find(room_.screens, message.screen, &Screen::name);
  if (screen == room_.screens.end()) {
    std::string names;
    for (const Screen& known : room_.screens) names += (names.empty() ? "" : ", ") + known.name;
    return send(member, RefuseMessage{"no screen of this room; it has " + names});
  }
  const std::string before = group_.join(member, message.screen, clock_.seconds());
  if (!before.empty()) send(before, RefuseMessage{"another process shows it now"});
  const bool has_scene = message.session == session_;
  send(member, WelcomeMessage{session_, *screen, room_.wait, has_scene ? Bytes() : scene_});
  needs_frame_ = true;
}

void ScreenServer::swap() {
  if (!group_.may_swap(clock_.seconds())) return;
  const double seconds = drawing_.seconds();
  const std::int64_t late_before = group_.late_count();
  const std::vector<std::string> members = group_.swap();
  for (const std::string& member : members) send(member, SwapMessage{frame_});
  if (members.empty() || group_.late_count() > late_before || !group_.late_frames().empty()) return;
  const std::lock_guard lock(mutex_);
  ++counts_.ready_frames;
  counts_.ready_seconds += seconds;
}

/// A screen that draws for long is silent as one whose process ended, but the connection of the
/// latter is gone, which sending notices. It hears again what it does when it is ready.
void ScreenServer::find_gone() {
  if (clock_.seconds() - asked_ < repeat_seconds) return;
  asked_ = clock_.seconds();
  for (const auto& [member, frame] : group_.late_frames()) send(member, SwapMessage{frame});
}

void ScreenServer::send_frame() {
  const double now = clock_.seconds();
  if (group_.is_drawing()) return;
  FrameMessage message;
  {
    const std::lock_guard lock(mutex_);
    const bool is_due =
        needs_frame_ || is_fresh_ || !room_.head_path.empty() || now - sent_ >= repeat_seconds;
    if (!is_due || state_.empty() || !has_view_) return;
    message.place = place_;
    message.look = look_;
    message.state = state_;
    is_fresh_ = false;
  }
  needs_frame_ = true;  // until a screen gets it
  const std::vector<std::string> members = group_.begin_frame(frame_ + 1, now);
  if (members.empty()) return;
  ++frame_;
  message.session = session_;
  message.frame = frame_;
  message.head.position = room_.observer;
  if (!room_.head_path.empty()) message.head = head_at(room_.head_path, now);
  if (tracked_) message.head = *tracked_;
  message.eye_separation = room_.eye_separation;
  const Bytes bytes = view::bytes_of(ToScreen(std::move(message)));
  drawing_ = Stopwatch();
  for (const std::string& member : members) send(member, bytes);
  sent_ = now;
  needs_frame_ = false;
  const std::lock_guard lock(mutex_);
  ++counts_.frames;
  counts_.frame_bytes = static_cast<std::int64_t>(bytes.size());
}

void ScreenServer::send(const std::string& member, const ToScreen& message) {
  send(member, view::bytes_of(message));
}

/// A peer that is gone is no error: it takes part no more. What a full queue does not take is lost.
void ScreenServer::send(const std::string& member, const Bytes& bytes) {
  try {
    const auto first = zmq::send_flags::sndmore | zmq::send_flags::dontwait;
    if (socket_.send(zmq::buffer(member), first)) {
      socket_.send(zmq::buffer(bytes), zmq::send_flags::dontwait);
    }
  } catch (const zmq::error_t& error) {
    if (error.num() != EHOSTUNREACH) throw;
    if (group_.leave(member)) ++gone_;
  }
}

}  // namespace tetwarp::view
