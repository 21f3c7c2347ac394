/// @file copy_ways.hpp
/// Copies of one array between device 0 and memory of the host, in several ways.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>

namespace tetwarp::bench {

enum class CopyDirection { to_host, to_device };

/// The shape of a StagingRing.
struct RingShape {
  std::size_t slot_bytes;
  std::int64_t slots;
  int threads;
};
/// That of the library.
RingShape usual_ring();

/// Every call copies the whole array and waits for it.
class CopyWays {
 public:
  /// @throws CudaError
  CopyWays(std::size_t bytes, CopyDirection direction, const RingShape& shape);
  ~CopyWays();
  CopyWays(const CopyWays&) = delete;
  CopyWays& operator=(const CopyWays&) = delete;

  /// Pageable memory, through the ring.
  void staged();
  /// Pageable memory, by the runtime.
  void by_runtime();
  /// Page-locked memory.
  void locked();
  /// The first two into memory that nothing has touched.
  void staged_untouched();
  void by_runtime_untouched();
  /// Page-locks the pageable memory and unlocks it.
  void lock();

  /// Whether the bytes arrive: copies others by the ring, and compares.
  bool is_right();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp::bench
