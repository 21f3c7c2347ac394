/// @file launch_observer.hpp
/// Interface of counters: called by emulated launches for what they do; chooses the blocks that
/// run.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace tetwarp::simt {

/// All calls come from one OS thread: launches that are observed run on one.
class LaunchObserver {
 public:
  virtual ~LaunchObserver() = default;

  /// @param kernel  mangled name of the kernel's type, which has the types of its arguments
  virtual void launch_begins(const std::string& kernel,
                             std::int64_t blocks,
                             std::int64_t threads) = 0;
  /// Whether a block of the launch runs; else it has no effect.
  virtual bool runs(std::int64_t block) = 0;
  /// A thread runs up to its next synchronization.
  /// @param stack  lowest byte of the memory of its local variables
  /// @param size   of that memory [bytes]
  virtual void lane_begins(const void* stack, std::size_t size) = 0;
  virtual void lane_ends() = 0;
  /// All lanes of a warp that could run have done so.
  /// @param first  thread of the warp
  virtual void warp_paused(unsigned first) = 0;
  /// All threads of the block have passed __syncthreads().
  virtual void barrier_passed() = 0;
  virtual void block_ends() = 0;
  virtual void launch_ends() = 0;

  /// The one that observes; null for none.
  static LaunchObserver*& current() {
    static LaunchObserver* observer = nullptr;
    return observer;
  }
};

}  // namespace tetwarp::simt
