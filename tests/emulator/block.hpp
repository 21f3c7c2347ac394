/// @file block.hpp
/// Emulation of one thread block on one OS thread: a fiber per CUDA thread, barriers and warp
/// exchanges between them; those that can never complete are reported as Fault.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/emulator/fiber.hpp"
#include "tests/emulator/launch_observer.hpp"
#include "tests/emulator/race_order.hpp"

namespace tetwarp::simt {

constexpr unsigned warp_size = 32;

/// Error of a kernel whose behavior is undefined on a GPU, or that would hang it.
class Fault : public std::runtime_error {
 public:
  explicit Fault(const std::string& problem) : std::runtime_error("simt: " + problem) {}
};

/// Order of threads where CUDA does not define one.
enum class ThreadOrder { forward, reverse, shuffled };

/// Order of threads, and the seed of the shuffled one.
struct Schedule {
  ThreadOrder order = ThreadOrder::forward;
  unsigned seed = 1;
};

/// Runs a block warp by warp, each up to its next barrier; a warp lane by lane, each up to its next
/// synchronization. If two schedules give different results, the kernel has a race.
///
/// Stricter than a GPU: a barrier or mask that includes a thread which has returned is a Fault.
class Block {
 public:
  /// The block that the calling OS thread runs.
  static Block& current() {
    if (chosen() != nullptr) return *chosen();
    static thread_local Block block;
    return block;
  }
  /// Makes a block the current one of the calling OS thread; null: its own.
  static void choose(Block* block) { chosen() = block; }

  /// Runs `kernel` once per thread.
  /// @param on_resume  called with the thread's number each time before it runs
  /// @throws Fault, and any exception of the kernel
  void run(unsigned thread_count,
           std::size_t shared_bytes,
           const Schedule& schedule,
           const std::function<void()>& kernel,
           const std::function<void(unsigned)>& on_resume) {
    start(thread_count, shared_bytes, schedule, kernel);
    go_on(on_resume);
    if (!is_done()) throw Fault("the grid of this launch cannot be synchronized");
  }

  /// The first part of run().
  void start(unsigned thread_count,
             std::size_t shared_bytes,
             const Schedule& schedule,
             const std::function<void()>& kernel) {
    while (fibers_.size() < thread_count) fibers_.push_back(std::make_unique<Fiber>());
    threads_.assign(thread_count, Thread{});
    order_ = schedule.order;
    random_.seed(schedule.seed);
    shared_.assign(shared_bytes, std::byte{0xcd});
    shared_.shrink_to_fit();  // so that the address sanitizer detects an overrun
    fault_ = nullptr;
    for (unsigned t = 0; t < thread_count; ++t) {
      fibers_[t]->start([this, t, &kernel] { run_thread(t, kernel); });
    }
    RaceThread::release_own(&begun_);
    for_each_race([this](const RaceThread& thread) { thread.acquire(&begun_); });
  }
  /// Runs all threads until they have returned or wait for the grid.
  void go_on(const std::function<void(unsigned)>& on_resume) {
    {
      const IgnoredAccesses of_emulation;
      const unsigned warp_count = (thread_count() + warp_size - 1) / warp_size;
      while (!is_done()) {
        for (const unsigned warp : ordered(warp_count)) run_warp(warp * warp_size, on_resume);
        if (release_barrier() == State::at_grid) return;
      }
    }
    for_each_race([this](const RaceThread& thread) { thread.release(&done_); });
    RaceThread::acquire_own(&done_);
  }
  /// Whether all threads have returned.
  bool is_done() const {
    return std::all_of(threads_.begin(), threads_.end(),
                       [](const Thread& thread) { return thread.state == State::done; });
  }
  /// Lets the threads continue that wait for the grid.
  void release_grid() {
    for (unsigned t = 0; t < thread_count(); ++t) threads_[t].state = State::ready;
  }
  /// What all threads have done is before what follows acquire_order() of any block.
  /// @param at  of the grid
  void release_order(void* at) const {
    if (!barrier_lines().note(threads_[0].line)) return;
    for_each_race([at](const RaceThread& thread) { thread.release(at); });
  }
  void acquire_order(void* at) const {
    for_each_race([at](const RaceThread& thread) { thread.acquire(at); });
  }

  /// Dynamic shared memory, filled with 0xcd when the block starts.
  void* shared() { return shared_.data(); }

  /// __syncthreads() of the running thread, called in source line `line`.
  void wait_at_barrier(int line) { wait(State::at_barrier, line); }

  /// A barrier of the whole grid, called in source line `line`.
  void wait_for_grid(int line) { wait(State::at_grid, line); }

  /// Threads of the block.
  unsigned thread_count() const { return static_cast<unsigned>(threads_.size()); }

  /// Lane of the running thread.
  unsigned lane() const { return running_ % warp_size; }

  /// Waits for the lanes of `mask`. @returns those of them whose predicate is true
  /// @param orders  whether it also orders the accesses of these lanes to memory
  unsigned ballot(unsigned mask, bool predicate, int line, bool orders = false) {
    const IgnoredAccesses of_emulation;
    Thread& self = threads_[running_];
    self.predicate = predicate;
    self.source_lane = lane();
    self.orders = orders;
    exchange(mask, line);
    return self.ballot;
  }

  /// Waits for the lanes of `mask`. @returns the value of `source_lane`
  template <class T>
  T shuffle(unsigned mask, T value, unsigned source_lane, int line) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= sizeof(Value));
    const IgnoredAccesses of_emulation;
    Thread& self = threads_[running_];
    std::memcpy(self.sent.data(), &value, sizeof(T));
    self.source_lane = source_lane;
    self.orders = false;
    exchange(mask, line);
    std::memcpy(&value, self.received.data(), sizeof(T));
    return value;
  }

 private:
  enum class State { ready, at_barrier, at_grid, at_exchange, done };
  using Value = std::array<std::byte, 32>;

  struct Thread {
    State state = State::ready;
    int line = 0;              ///< source line of the synchronization that it waits in
    unsigned mask = 0;         ///< of the exchange that it waits in
    unsigned source_lane = 0;  ///< lane whose value it reads
    bool predicate = false;
    bool orders = false;  ///< the exchange orders accesses to memory
    Value sent{};
    unsigned ballot = 0;  ///< results of the exchange
    Value received{};
  };

  void run_thread(unsigned t, const std::function<void()>& kernel) {
    try {
      kernel();
    } catch (...) {
      fault_ = std::current_exception();  // rethrown by run_warp(), on the scheduler's stack
    }
    threads_[t].state = State::done;
  }

  void run_warp(unsigned first, const std::function<void(unsigned)>& on_resume) {
    const unsigned lane_count = std::min(warp_size, thread_count() - first);
    LaunchObserver* const observer = LaunchObserver::current();
    do {
      for (const unsigned lane : ordered(lane_count)) {
        running_ = first + lane;
        if (threads_[running_].state != State::ready) continue;
        on_resume(running_);
        Fiber& fiber = *fibers_[running_];
        if (observer != nullptr) observer->lane_begins(fiber.stack(), Fiber::stack_bytes);
        fiber.resume();
        if (observer != nullptr) observer->lane_ends();
        if (fault_) std::rethrow_exception(fault_);
      }
      if (observer != nullptr) observer->warp_paused(first);
    } while (complete_exchanges(first, lane_count));
  }

  void wait(State state, int line) {
    const IgnoredAccesses of_emulation;
    Thread& self = threads_[running_];
    self.state = state;
    self.line = line;
    fibers_[running_]->suspend();
  }

  void exchange(unsigned mask, int line) {
    Thread& self = threads_[running_];
    if (!(mask >> lane() & 1)) {
      throw Fault("line " + std::to_string(line) + ": lane " + std::to_string(lane()) +
                  " is outside its own mask");
    }
    const unsigned source = running_ - lane() + self.source_lane;
    if (!(mask >> self.source_lane & 1) || source >= thread_count()) {
      throw Fault("line " + std::to_string(line) + ": lane " + std::to_string(lane()) +
                  " reads lane " + std::to_string(self.source_lane) + ", which takes no part");
    }
    self.mask = mask;
    wait(State::at_exchange, line);
  }

  /// Completes the exchanges that all their lanes have reached. @returns whether there was one
  bool complete_exchanges(unsigned first, unsigned lane_count) {
    bool is_any = false;
    while (complete_exchange(first, lane_count)) is_any = true;
    return is_any;
  }
  /// Completes one of them.
  bool complete_exchange(unsigned first, unsigned lane_count) {
    for (unsigned lane = 0; lane < lane_count; ++lane) {
      const Thread& waiting = threads_[first + lane];
      if (waiting.state != State::at_exchange || missing_lane(first, lane) < lane_count) continue;
      const unsigned mask = waiting.mask;
      unsigned ballot = 0;
      for (unsigned l = 0; l < lane_count; ++l) {
        if (mask >> l & 1) ballot |= unsigned{threads_[first + l].predicate} << l;
      }
      for (unsigned l = 0; l < lane_count; ++l) {
        if (!(mask >> l & 1)) continue;
        Thread& member = threads_[first + l];
        member.ballot = ballot;
        member.received = threads_[first + member.source_lane].sent;
        member.state = State::ready;
      }
      if (waiting.orders && barrier_lines().note(waiting.line)) order_lanes(first, mask);
      return true;
    }
    return false;
  }

  /// First lane that has not reached the exchange in which `lane` waits; warp_size if none.
  unsigned missing_lane(unsigned first, unsigned lane) const {
    const Thread& waiting = threads_[first + lane];
    for (unsigned l = 0; l < warp_size && first + l < thread_count(); ++l) {
      const Thread& peer = threads_[first + l];
      const bool has_arrived = peer.state == State::at_exchange && peer.mask == waiting.mask &&
                               peer.line == waiting.line;
      if (waiting.mask >> l & 1 && !has_arrived) return l;
    }
    return warp_size;
  }

  template <class Visit>
  void for_each_race(const Visit& visit) const {
    if (!has_thread_sanitizer) return;
    for (unsigned t = 0; t < thread_count(); ++t) visit(fibers_[t]->race());
  }
  void order_lanes(unsigned first, unsigned mask) {
    if (!has_thread_sanitizer) return;
    char* const at = &of_lanes_[{first, mask}];
    for (const bool is_release : {true, false}) {
      for (unsigned lane = 0; lane < warp_size && first + lane < thread_count(); ++lane) {
        const RaceThread& race = fibers_[first + lane]->race();
        if (mask >> lane & 1) is_release ? race.release(at) : race.acquire(at);
      }
    }
  }

  static Block*& chosen() {
    static thread_local Block* block = nullptr;
    return block;
  }

  /// Releases all threads from the barrier that they wait at, unless it is that of the grid.
  /// @return  what they waited for
  /// @throws Fault if some thread cannot reach it
  State release_barrier() {
    if (is_done()) return State::done;
    const Thread& first = threads_[0];
    for (unsigned t = 0; t < thread_count(); ++t) {
      const Thread& thread = threads_[t];
      if (thread.state == State::at_exchange) {
        const unsigned lane = t % warp_size;
        const unsigned missing = missing_lane(t - lane, lane);
        throw Fault(where(t) + " for lane " + std::to_string(missing) + ": " +
                    where(t - lane + missing));
      }
      if (thread.state != first.state ||
          ((thread.state == State::at_barrier || thread.state == State::at_grid) &&
           thread.line != first.line)) {
        throw Fault("barrier not reached by all threads: " + where(0) + ", " + where(t));
      }
    }
    if (first.state == State::at_grid) return State::at_grid;
    if (LaunchObserver::current() != nullptr) LaunchObserver::current()->barrier_passed();
    release_order(&at_barrier_);
    acquire_order(&at_barrier_);
    for (unsigned t = 0; t < thread_count(); ++t) threads_[t].state = State::ready;
    return State::at_barrier;
  }

  std::string where(unsigned t) const {
    const Thread& thread = threads_[t];
    const std::string name = "thread " + std::to_string(t);
    if (thread.state == State::done) return name + " has left the kernel";
    return name + " waits in line " + std::to_string(thread.line);
  }

  /// 0 to count - 1 in the schedule's order. @pre count <= 32
  std::vector<unsigned> ordered(unsigned count) {
    std::vector<unsigned> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0u);
    if (order_ == ThreadOrder::reverse) std::reverse(numbers.begin(), numbers.end());
    if (order_ == ThreadOrder::shuffled) std::shuffle(numbers.begin(), numbers.end(), random_);
    return numbers;
  }

  std::vector<std::unique_ptr<Fiber>> fibers_;  ///< of threads; kept from launch to launch
  std::vector<Thread> threads_;
  unsigned running_ = 0;
  ThreadOrder order_ = ThreadOrder::forward;
  std::minstd_rand random_;
  std::vector<std::byte> shared_;
  std::exception_ptr fault_;
  char begun_ = 0, done_ = 0, at_barrier_ = 0;              ///< addresses where threads are ordered
  std::map<std::pair<unsigned, unsigned>, char> of_lanes_;  ///< by first thread and mask
};

}  // namespace tetwarp::simt
