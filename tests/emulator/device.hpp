/// @file device.hpp
/// The emulated CUDA device: memory, and streams that run work as late or as early as CUDA permits.
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
#include <new>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <typeinfo>
#include <utility>
#include <vector>

#include "tests/emulator/error.hpp"
#include "tests/emulator/simt.hpp"

namespace tetwarp::simt {

struct Stream;

/// Work captured from a stream, in order.
using Recording = std::vector<std::function<void()>>;

/// A point in a stream: before its item number `item`.
struct Event {
  Stream* stream = nullptr;  ///< null: never recorded, counts as completed
  std::uint64_t item = 0;

  bool is_passed() const;
  void pass() const;  ///< runs the work before it
};

/// A queue of work; `done` of the `queued` items have run.
struct Stream {
  struct Item {
    Event after;  ///< must be passed before the item runs
    std::function<void()> run;
  };
  std::deque<Item> work;
  std::uint64_t queued = 0;
  std::uint64_t done = 0;
  std::optional<Recording> recording;  ///< set while capturing: work is stored here and not run
  std::thread::id recorded_by;         ///< the thread that captures
  int device = 0;                      ///< the one that was current when the stream was made

  void enqueue(std::function<void()> run, const Event& after = {}) {
    if (recording) return recording->push_back(std::move(run));
    work.push_back({after, std::move(run)});
    ++queued;
  }
  void run_until(std::uint64_t item) {
    while (done < item) run_one();
  }
  /// Runs items until the next one depends on unfinished work of another stream.
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

/// Calls of the runtime that are recorded, one letter each.
enum class ApiCall : char {
  launch = 'L',
  allocate = 'A',
  release = 'F',
  wait = 'W',  ///< of the host for a stream or an event
  copy_to_device = 'U',
  copy_to_host = 'D',
  copy_within = 'C',  ///< from device to device
  fill = 'Z',
  record = 'R',  ///< of an event
  graph = 'G'    ///< launch of a graph; each item of it is noted as a launch, too
};

/// A kernel, named by the types of its arguments, and the blocks and threads that it was launched
/// with.
struct LaunchShape {
  std::string kernel;
  std::int64_t blocks = 0, threads = 0;
  auto operator<=>(const LaunchShape&) const = default;
};

/// Bytes that crossed between host and device.
struct CopiedBytes {
  std::size_t to_device = 0, to_host = 0;
};

/// The one emulated device: memory, streams and the record of calls.
class Device {
 public:
  std::recursive_mutex lock;

  static constexpr int none = -1;
  /// Index, in order of creation, of the stream whose work runs as early as events allow; `none`
  /// for no stream. Work of other streams runs when the host waits for it.
  int eager_stream = none;
  /// Number of calls of cudaStreamWaitEvent before the one that is ignored; `none` ignores none.
  /// With it a test shows that each wait is needed.
  int skipped_wait = none;
  /// Number of allocations, of device or page-locked memory, before the one that fails; `none`
  /// fails none.
  int failing_allocation = none;
  /// The error that all calls return, as after an illegal access of a kernel.
  cudaError_t failure = cudaSuccess;
  /// As on sm_90; blocks may use fewer multiprocessors.
  int most_shared_bytes = 227 * 1024, multiprocessors = 4;
  /// Whether a launch may synchronize its whole grid.
  int is_cooperative = 1;

  static Device& only() {
    static Device device;
    return device;
  }

  /// Returns the letters (ApiCall) of the calls since the last take_calls().
  std::string take_calls() {
    const std::lock_guard guard(lock);
    return std::exchange(calls_, {});
  }
  void note(ApiCall call) { calls_ += static_cast<char>(call); }
  /// Returns the different launches since the last take_launches(), recorded ones included.
  std::set<LaunchShape> take_launches() {
    const std::lock_guard guard(lock);
    return std::exchange(launches_, {});
  }
  void note_launch(const std::type_info& kernel, dim3 grid, dim3 block) {
    launches_.insert({kernel.name(), std::int64_t{grid.x} * grid.y * grid.z,
                      std::int64_t{block.x} * block.y * block.z});
  }
  /// Returns the bytes copied since the last take_copied().
  CopiedBytes take_copied() {
    const std::lock_guard guard(lock);
    return std::exchange(copied_, {});
  }
  void note_copy(ApiCall call, std::size_t size) {
    note(call);
    if (call == ApiCall::copy_to_device) copied_.to_device += size;
    if (call == ApiCall::copy_to_host) copied_.to_host += size;
  }

  /// @returns memory filled with 0xcd, aligned as that of a device
  void* allocate(std::size_t size, bool is_pinned) {
    std::unique_ptr<std::byte[], Free> memory(new (std::align_val_t{alignment})
                                                  std::byte[std::max<std::size_t>(size, 1)]);
    std::memset(memory.get(), 0xcd, size);
    std::byte* const data = memory.get();
    memory_[data] = {std::move(memory), size, is_pinned};
    return data;
  }
  /// Runs all pending work, then frees the memory. @returns false if it was not allocated here
  bool release(const void* data) {
    run_all();
    return memory_.erase(static_cast<const std::byte*>(data)) == 1;
  }
  /// Bytes of all memory of the device that is allocated now.
  std::size_t allocated() const {
    std::size_t sum = 0;
    for (const auto& [begin, memory] : memory_) sum += memory.is_pinned ? 0 : memory.size;
    return sum;
  }
  /// First and one past the last byte of each piece of its memory, in ascending order.
  std::vector<std::pair<std::uintptr_t, std::uintptr_t>> ranges() const {
    std::vector<std::pair<std::uintptr_t, std::uintptr_t>> found;
    for (const auto& [begin, memory] : memory_) {
      const auto first = reinterpret_cast<std::uintptr_t>(begin);
      if (!memory.is_pinned) found.emplace_back(first, first + memory.size);
    }
    return found;
  }
  bool is_on_device(const void* data, std::size_t size) const {
    return is_within(data, size, false);
  }
  bool is_pinned(const void* data, std::size_t size) const { return is_within(data, size, true); }

  /// Registers memory that the caller owns as pinned.
  void pin(void* data, std::size_t size) {
    memory_[static_cast<const std::byte*>(data)] = {nullptr, size, true};
  }

  bool allocation_fails() { return failing_allocation != none && failing_allocation-- == 0; }

  Stream* make_stream() {
    Stream* const stream = streams_.emplace_back(std::make_unique<Stream>()).get();
    stream->device = current_device;
    return stream;
  }
  /// The stream of a handle; null and cudaStreamLegacy are the default stream.
  Stream& stream(cudaStream_t handle) {
    return handle == nullptr || handle == cudaStreamLegacy ? default_stream_
                                                           : *static_cast<Stream*>(handle);
  }
  bool is_recorded_by_this_thread() const {
    return std::any_of(streams_.begin(), streams_.end(), [](const auto& stream) {
      return stream->recording && stream->recorded_by == std::this_thread::get_id();
    });
  }
  /// Kernels are loaded when they are first used, which must not happen while a stream is captured.
  void load(const void* kernel) { loaded_.insert(kernel); }
  bool is_loaded(const void* kernel) const { return loaded_.contains(kernel); }

  void end_stream(Stream* stream) {
    stream->run_until(stream->queued);
    const auto own = std::find_if(streams_.begin(), streams_.end(),
                                  [&](const auto& one) { return one.get() == stream; });
    ended_streams_.push_back(std::move(*own));
    streams_.erase(own);
  }
  void run_all() {
    default_stream_.run_until(default_stream_.queued);
    for (const auto& stream : streams_) stream->run_until(stream->queued);
  }
  /// Runs the work of eager_stream that is ready; called after each change that may make some
  /// ready.
  void run_eager() {
    const auto number = static_cast<std::size_t>(eager_stream);
    if (eager_stream != none && number < streams_.size()) streams_[number]->run_ready();
  }

 private:
  static constexpr std::size_t alignment = 256;
  struct Free {
    void operator()(std::byte* bytes) const {
      ::operator delete[](bytes, std::align_val_t{alignment});
    }
  };
  struct Memory {
    std::unique_ptr<std::byte[], Free> bytes;
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
  std::vector<std::unique_ptr<Stream>> ended_streams_;  ///< events may still refer to them
  Stream default_stream_;
  std::set<const void*> loaded_;
  std::string calls_;
  std::set<LaunchShape> launches_;
  CopiedBytes copied_;
};

/// Enqueues run(), which runs a kernel, on a stream; with a null stream runs it immediately.
/// @throws Fault  the stream belongs to another than the current device, or is captured and the
///                kernel was not loaded before
template <class Kernel, class Run>
void enqueue_kernel(cudaStream_t stream, Kernel kernel, dim3 grid, dim3 block, const Run& run) {
  if (stream == nullptr) return run();
  Device& device = Device::only();
  const std::lock_guard guard(device.lock);
  Stream& own = device.stream(stream);
  const auto* const address = reinterpret_cast<const void*>(kernel);
  if (own.device != current_device) {
    throw Fault("a kernel is launched on a stream of another device");
  }
  if (own.recording && !device.is_loaded(address)) {
    throw Fault("a kernel is first used while a stream is captured");
  }
  device.load(address);
  device.note(ApiCall::launch);
  device.note_launch(typeid(kernel), grid, block);
  own.enqueue(run);
  device.run_eager();
}

template <class Kernel, class... Args>
void launch_on(cudaStream_t stream,
               Kernel kernel,
               dim3 grid,
               dim3 block,
               std::size_t shared_bytes,
               const Args&... args) {
  enqueue_kernel(stream, kernel, grid, block,
                 [=] { launch(kernel, grid, block, shared_bytes, args...); });
}

template <class Kernel, class... Args>
void launch_cooperative_on(cudaStream_t stream,
                           Kernel kernel,
                           dim3 grid,
                           dim3 block,
                           std::size_t shared_bytes,
                           const Args&... args) {
  enqueue_kernel(stream, kernel, grid, block,
                 [=] { launch_cooperative(kernel, grid, block, shared_bytes, args...); });
}

}  // namespace tetwarp::simt
