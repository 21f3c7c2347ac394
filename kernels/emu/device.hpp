/// @file device.hpp
/// A CUDA device on the CPU: memory, and streams whose work runs as late, or as early, as CUDA
/// allows.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/emu/simt.hpp"

namespace tetwarp::simt {

struct Stream;

/// What was put on a stream while it was captured.
using Recording = std::vector<std::function<void()>>;

/// A place in a stream.
struct Event {
  Stream* stream = nullptr;  ///< null: never recorded, nothing to wait for
  std::uint64_t item = 0;

  bool is_passed() const;
  void pass() const;
};

/// Work in its order; `done` of `queued` items have run.
struct Stream {
  struct Item {
    Event after;  ///< has to be passed first
    std::function<void()> run;
  };
  std::deque<Item> work;
  std::uint64_t queued = 0;
  std::uint64_t done = 0;
  std::optional<Recording> recording;  ///< takes what is put on the stream, which does not run

  void enqueue(std::function<void()> run, const Event& after = {}) {
    if (recording) return recording->push_back(std::move(run));
    work.push_back({after, std::move(run)});
    ++queued;
  }
  void run_until(std::uint64_t item) {
    while (done < item) run_one();
  }
  /// As far as it gets without what other streams have not done yet.
  void run_ready() {
    while (!work.empty() && work.front().after.is_passed()) run_one();
  }

 private:
  void run_one() {
    const Item next = std::move(work.front());
    work.pop_front();
    next.after.pass();
    ++done;
    next.run();
  }
};

inline bool Event::is_passed() const {
  return stream == nullptr || stream->done >= item;
}
inline void Event::pass() const {
  if (stream != nullptr) stream->run_until(item);
}

/// What the host asked for, in order.
enum class ApiCall : char {
  launch = 'L',
  allocate = 'A',
  release = 'F',
  wait = 'W',            ///< for a stream or an event
  copy_to_device = 'U',  ///< from the host
  copy_to_host = 'D',
  copy_within = 'C',
  fill = 'Z'
};

/// The one device.
class Device {
 public:
  std::recursive_mutex lock;

  static constexpr int none = -1;
  /// Number of the stream, in their order of making, that runs as soon as events let it; the others
  /// run when somebody waits for them.
  int eager_stream = none;
  /// Number of the cudaStreamWaitEvent from now on that does nothing, to see that it is missed.
  int skipped_wait = none;

  static Device& only() {
    static Device device;
    return device;
  }

  /// The calls since the last time it was asked, one letter each.
  std::string take_calls() {
    const std::lock_guard guard(lock);
    return std::exchange(calls_, {});
  }
  void note(ApiCall call) { calls_ += static_cast<char>(call); }

  void* allocate(std::size_t size, bool is_pinned) {
    auto memory = std::make_unique<std::byte[]>(std::max<std::size_t>(size, 1));
    std::memset(memory.get(), 0xcd, size);
    std::byte* const data = memory.get();
    memory_[data] = {std::move(memory), size, is_pinned};
    return data;
  }
  /// @returns whether there was such memory
  bool release(const void* data) {
    run_all();
    return memory_.erase(static_cast<const std::byte*>(data)) == 1;
  }
  bool is_on_device(const void* data, std::size_t size) const {
    return is_within(data, size, false);
  }
  bool is_pinned(const void* data, std::size_t size) const { return is_within(data, size, true); }

  /// Host memory of others becomes pinned.
  void pin(void* data, std::size_t size) {
    memory_[static_cast<const std::byte*>(data)] = {nullptr, size, true};
  }

  Stream* make_stream() { return streams_.emplace_back(std::make_unique<Stream>()).get(); }
  void end_stream(Stream* stream) {
    stream->run_until(stream->queued);
    std::erase_if(streams_, [&](const auto& one) { return one.get() == stream; });
  }
  void run_all() {
    for (const auto& stream : streams_) stream->run_until(stream->queued);
  }
  /// To be called after everything that may let the stream eager_stream go on.
  void run_eager() {
    const auto number = static_cast<std::size_t>(eager_stream);
    if (eager_stream != none && number < streams_.size()) streams_[number]->run_ready();
  }

 private:
  struct Memory {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size;
    bool is_pinned;
  };

  bool is_within(const void* data, std::size_t size, bool is_pinned) const {
    const auto* const begin = static_cast<const std::byte*>(data);
    auto after = memory_.upper_bound(begin);
    if (after == memory_.begin()) return false;
    const auto& [start, memory] = *--after;
    return memory.is_pinned == is_pinned && begin + size <= start + memory.size;
  }

  std::map<const std::byte*, Memory> memory_;
  std::vector<std::unique_ptr<Stream>> streams_;
  std::string calls_;
};

/// Runs a kernel on a stream; without one at once.
template <class Kernel, class... Args>
void launch_on(cudaStream_t stream,
               Kernel kernel,
               dim3 grid,
               dim3 block,
               std::size_t shared_bytes,
               const Args&... args) {
  if (stream == nullptr) return launch(kernel, grid, block, shared_bytes, args...);
  const std::lock_guard guard(Device::only().lock);
  Device::only().note(ApiCall::launch);
  static_cast<Stream*>(stream)->enqueue(
      [=] { launch(kernel, grid, block, shared_bytes, args...); });
  Device::only().run_eager();
}

}  // namespace tetwarp::simt
