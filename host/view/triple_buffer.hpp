/// @file triple_buffer.hpp
/// TripleBuffer: hands the newest of a stream of values from one thread to another.
#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace tetwarp::view {

/// One thread writes, one reads; neither waits for the other. Values that the reader did not take
/// in time are overwritten by newer ones. The three values live as long as the buffer, so that
/// what they allocate is used again.
template <class T>
class TripleBuffer {
 public:
  /// The writer's value: one of the last but two that were published, or new.
  T& back() { return slots_[back_]; }
  /// Makes the writer's value the newest one.
  void publish() {
    const std::uint8_t before =
        middle_.exchange(static_cast<std::uint8_t>(back_ | fresh), std::memory_order_acq_rel);
    back_ = before & index_mask;
  }
  /// Whether a published value has not been taken yet.
  bool is_waiting() const { return (middle_.load(std::memory_order_acquire) & fresh) != 0; }

  /// Takes the newest value for the reader. @returns false if there is none since the last call
  bool take() {
    if (!is_waiting()) return false;
    const std::uint8_t newest =
        middle_.exchange(static_cast<std::uint8_t>(front_), std::memory_order_acq_rel);
    front_ = newest & index_mask;
    return true;
  }
  /// The reader's value.
  T& front() { return slots_[front_]; }

 private:
  static constexpr std::uint8_t fresh = 4, index_mask = 3;

  std::array<T, 3> slots_{};
  std::size_t back_ = 0, front_ = 2;
  std::atomic<std::uint8_t> middle_{1};
};

}  // namespace tetwarp::view
