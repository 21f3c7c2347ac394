/// @file screen_frames.cpp
/// Time from sending a frame to three screens of this machine until all say that it is ready, where
/// none draws anything: a table by the size of the state. tetwarp_bench_screens [FRAMES]
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "host/base/stopwatch.hpp"
#include "host/view/link/screen_link.hpp"
#include "host/view/link/screen_server.hpp"
#include "host/view/screens/room.hpp"
#include "host/view/screens/room_file.hpp"
#include "host/view/screens/screen_message.hpp"

namespace tetwarp::view {
namespace {
constexpr auto pause = std::chrono::microseconds(50);
constexpr double receive_seconds = 0.1;
constexpr double most_seconds = 10;  ///< of anything that is waited for

/// Joins, and says of each frame at once that it is ready. Without a master it ends.
void follow(const std::string& address, const std::string& screen, const std::atomic<bool>& ends) {
  ScreenLink link(address, {});
  if (!link.wait_for_master(most_seconds)) return;
  link.send(JoinMessage{screen, 0});
  while (!ends) {
    const auto message = link.receive(receive_seconds);
    const auto* const frame = message ? std::get_if<FrameMessage>(&*message) : nullptr;
    if (frame != nullptr) link.send(ReadyMessage{frame->frame});
  }
}

/// @throws std::runtime_error  `is_done` does not come true in time
void wait_for(const char* what, const std::function<bool()>& is_done) {
  const Stopwatch since;
  while (!is_done()) {
    if (since.seconds() > most_seconds) {
      throw std::runtime_error(std::string(what) + ": nothing happens for " +
                               std::to_string(static_cast<int>(most_seconds)) + " s");
    }
    std::this_thread::sleep_for(pause);
  }
}

/// The screens, which end with it.
class Screens {
 public:
  Screens(const std::string& address, const Room& room) {
    for (const Screen& screen : room.screens) {
      threads_.emplace_back([this, address, name = screen.name] { follow(address, name, ends_); });
    }
  }
  Screens(const Screens&) = delete;
  Screens& operator=(const Screens&) = delete;
  ~Screens() {
    ends_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::atomic<bool> ends_ = false;
  std::vector<std::thread> threads_;
};

/// @returns seconds of a frame
/// @throws std::runtime_error  screens do not join or do not draw
double measure(const Bytes& state, std::int64_t frames) {
  Room room = parse_room(room_text("wall"), "wall");
  room.address = "tcp://127.0.0.1:*";
  ScreenServer server(room, Bytes(1), {});
  server.set_view({{}, {1, 2, 3}, {}}, {});
  const Screens screens(server.address(), room);
  const auto count = static_cast<std::int64_t>(room.screens.size());
  wait_for("screens that join", [&] { return server.counts().screens >= count; });
  const ScreenCounts first = server.counts();
  for (std::int64_t n = 0; n < frames; ++n) {
    const std::int64_t done = server.counts().ready_frames;
    server.set_state(state);
    wait_for("screens that are ready", [&] { return server.counts().ready_frames > done; });
  }
  const ScreenCounts last = server.counts();
  return (last.ready_seconds - first.ready_seconds) /
         static_cast<double>(last.ready_frames - first.ready_frames);
}
}  // namespace
}  // namespace tetwarp::view

int main(int argument_count, char** arguments) {
  const long long frames = argument_count > 1 ? std::atoll(arguments[1]) : 2000;
  if (frames < 1) {
    std::fputs("tetwarp_bench_screens: FRAMES: expected a number above 0\n", stderr);
    return 1;
  }
  std::puts("| bytes of the state | us until all are ready |\n|---|---|");
  try {
    for (const std::size_t bytes : {1'000, 24'000, 50'000}) {
      const double seconds = tetwarp::view::measure(tetwarp::view::Bytes(bytes), frames);
      std::printf("| %zu | %.0f |\n", bytes, 1e6 * seconds);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tetwarp_bench_screens: %s\n", error.what());
    return 1;
  }
}
