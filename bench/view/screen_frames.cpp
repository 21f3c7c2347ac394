/// @file screen_frames.cpp
/// Time from sending a frame to three screens of this machine until all say that it is ready, where
/// none draws anything: a table by the size of the state. tetwarp_bench_screens [FRAMES]
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "host/view/link/screen_link.hpp"
#include "host/view/link/screen_server.hpp"
#include "host/view/screens/room_file.hpp"

namespace tetwarp::view {
namespace {
constexpr auto pause = std::chrono::microseconds(50);
constexpr double receive_seconds = 0.1;

/// Joins, and says of each frame at once that it is ready.
void follow(const std::string& address, const std::string& screen, const std::atomic<bool>& ends) {
  ScreenLink link(address, {});
  link.wait_for_master(10);
  link.send(JoinMessage{screen, 0});
  while (!ends) {
    const auto message = link.receive(receive_seconds);
    const auto* const frame = message ? std::get_if<FrameMessage>(&*message) : nullptr;
    if (frame != nullptr) link.send(ReadyMessage{frame->frame});
  }
}

/// @returns seconds of a frame
double measure(const Bytes& state, std::int64_t frames) {
  Room room = parse_room(room_text("wall"), "wall");
  room.address = "tcp://127.0.0.1:*";
  ScreenServer server(room, Bytes(1), {});
  server.set_view({{}, {1, 2, 3}, {}}, {});
  std::atomic<bool> ends = false;
  std::vector<std::thread> screens;
  for (const Screen& screen : room.screens) {
    screens.emplace_back([&] { follow(server.address(), screen.name, ends); });
  }
  const auto count = static_cast<std::int64_t>(room.screens.size());
  while (server.counts().screens < count) std::this_thread::sleep_for(pause);
  const ScreenCounts first = server.counts();
  for (std::int64_t n = 0; n < frames; ++n) {
    const std::int64_t done = server.counts().ready_frames;
    server.set_state(state);
    while (server.counts().ready_frames == done) std::this_thread::sleep_for(pause);
  }
  const ScreenCounts last = server.counts();
  ends = true;
  for (std::thread& screen : screens) screen.join();
  return (last.ready_seconds - first.ready_seconds) /
         static_cast<double>(last.ready_frames - first.ready_frames);
}
}  // namespace
}  // namespace tetwarp::view

int main(int argument_count, char** arguments) {
  const long long frames = argument_count > 1 ? std::atoll(arguments[1]) : 2000;
  std::puts("| bytes of the state | us until all are ready |\n|---|---|");
  for (const std::size_t bytes : {1'000, 24'000, 50'000}) {
    const double seconds = tetwarp::view::measure(tetwarp::view::Bytes(bytes), frames);
    std::printf("| %zu | %.0f |\n", bytes, 1e6 * seconds);
  }
}
