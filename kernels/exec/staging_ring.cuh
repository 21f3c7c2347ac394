/// @file staging_ring.cuh
/// Copies of large arrays between a device and pageable memory of the host.
#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "kernels/base/host_tasks.hpp"
#include "kernels/base/slice_pieces.hpp"
#include "kernels/exec/exec_stream.cuh"

namespace tetwarp {

/// A ring of page-locked memory: threads of the host fill or empty some slots while the device
/// copies others. The runtime copies pageable memory in stages of its own on one thread, at a
/// quarter of the rate of the bus. Memory of the caller is not locked in place: it may be freed at
/// any time, and an address that is allocated again would still name the pages that were locked.
///
/// A piece of an array takes slot number piece % slots. One copy uses the ring at a time.
class StagingRing {
 public:
  struct Shape {
    std::size_t slot_bytes = std::size_t{2} << 20;
    std::int64_t slots = 24;
    /// Eight threads copy faster than the bus.
    int threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 8U));
  };

  /// The ring pays from this size of an array on.
  static constexpr std::size_t least_bytes = std::size_t{4} << 20;

  /// The ring of this process for a device, made when first needed and kept until the process ends.
  static StagingRing& of(int device) {
    static std::mutex making;
    static auto* const rings = new std::map<int, StagingRing>;  // outlives the device's runtime
    const std::lock_guard lock(making);
    const DeviceScope scope(device);
    return rings->try_emplace(device, device, Shape{}).first->second;
  }

  /// @pre the device is current
  StagingRing(int device, const Shape& shape)
      : device_(device), shape_(shape), slots_(static_cast<std::size_t>(shape.slots)) {
    memory_.reserve(static_cast<std::int64_t>(shape.slot_bytes) * shape.slots);
  }

  /// Copies to the host after the work on the stream; returns when `to` has the data.
  /// @param from, to  first byte to copy
  void download(const std::byte* from, std::byte* to, const SliceBytes& part, cudaStream_t stream) {
    const std::lock_guard alone(transfer_);
    const std::vector<SlicePiece> pieces = pieces_for(part);
    const auto count = static_cast<std::int64_t>(pieces.size());
    const std::size_t slice = part.row * part.pitch;
    const auto receive = [&](std::int64_t p) {
      const SlicePiece& piece = pieces[static_cast<std::size_t>(p)];
      const std::lock_guard lock(calls_);
      copy_slices(from + piece.offset, memory(p), boxes_of(piece, part), part.rows, stream);
      slot(p).copied.record(stream);
      slot(p).piece = p;
    };
    run(
        stream, count,
        [&] {
          for (Slot& one : slots_) {
            one.piece = -1;
            one.copied.wait();  // for an upload before
          }
          for (std::int64_t p = 0; p < std::min(count, shape_.slots); ++p) receive(p);
        },
        [&](std::int64_t p) {
          const SlicePiece& piece = pieces[static_cast<std::size_t>(p)];
          if (!await(slot(p), p)) return;
          for (std::size_t k = 0; k < piece.slices; ++k) {
            stream_copy(memory(p) + k * piece.run, to + piece.offset + k * slice, piece.run);
          }
          if (p + shape_.slots < count) receive(p + shape_.slots);
        });
  }

  /// Copies to the device, on the stream. Returns when `from` has been read.
  void upload(const std::byte* from, std::byte* to, std::size_t size, cudaStream_t stream) {
    const std::lock_guard alone(transfer_);
    const std::vector<SlicePiece> pieces = pieces_for({size, 1, 1, 1});
    run(
        stream, static_cast<std::int64_t>(pieces.size()),
        [&] {
          for (std::int64_t p = 0; p < shape_.slots; ++p) slot(p).piece = p - shape_.slots;
        },
        [&](std::int64_t p) {
          const SlicePiece& piece = pieces[static_cast<std::size_t>(p)];
          if (!await(slot(p), p - shape_.slots)) return;
          stream_copy(from + piece.offset, memory(p), piece.run);
          const std::lock_guard lock(calls_);
          check_cuda(cudaMemcpyAsync(to + piece.offset, memory(p), piece.run,
                                     cudaMemcpyHostToDevice, stream),
                     "cudaMemcpyAsync to device");
          slot(p).copied.record(stream);
          slot(p).piece = p;
        });
  }

 private:
  struct Slot {
    DeviceEvent copied;                   ///< by the device: its last piece
    std::atomic<std::int64_t> piece = 0;  ///< that one, in the current transfer
  };

  std::vector<SlicePiece> pieces_for(const SliceBytes& part) const {
    return pieces_of(part, shape_.slot_bytes, static_cast<std::size_t>(shape_.threads));
  }
  /// A piece of whole slices keeps their rows, else it is one row.
  static SliceBytes boxes_of(const SlicePiece& piece, const SliceBytes& part) {
    if (piece.slices == 1) return {piece.run, 1, 1, 1};
    return {part.row, part.rows, part.pitch, piece.slices};
  }
  Slot& slot(std::int64_t piece) { return slots_[static_cast<std::size_t>(piece % shape_.slots)]; }
  std::byte* memory(std::int64_t piece) const {
    return memory_.view(0).data +
           static_cast<std::size_t>(piece % shape_.slots) * shape_.slot_bytes;
  }

  /// Calls prepare(), then task(p) for every piece p on threads of the host. After an error all
  /// return, and no copy uses the ring any longer.
  template <class Prepare, class Task>
  void run(cudaStream_t stream, std::int64_t count, const Prepare& prepare, const Task& task) {
    has_failed_ = false;
    try {
      prepare();
      run_host_tasks(shape_.threads, count, [&](std::int64_t p) {
        try {
          const DeviceScope scope(device_);
          task(p);
        } catch (...) {
          has_failed_ = true;
          throw;
        }
      });
    } catch (...) {
      cudaStreamSynchronize(stream);
      cudaGetLastError();  // the first error is reported
      throw;
    }
  }

  /// Waits until the device has copied a piece. @returns false after an error of another thread
  bool await(const Slot& slot, std::int64_t piece) {
    for (unsigned tries = 1; !has_failed_; ++tries) {
      if (slot.piece == piece) {
        // One thread at a time asks: calls of the runtime wait for each other.
        const std::unique_lock lock(calls_, std::try_to_lock);
        if (lock && slot.copied.is_done()) return true;
      }
      if (tries % 64 == 0) std::this_thread::yield();
    }
    return false;
  }

  int device_;
  Shape shape_;
  std::vector<Slot> slots_;
  PinnedBuffer<std::byte> memory_;
  std::mutex transfer_;  ///< one copy at a time
  std::mutex calls_;     ///< of the runtime
  std::atomic<bool> has_failed_ = false;
};

}  // namespace tetwarp
