/// @file copy_ways.cu
#include "bench/measure/copy_ways.hpp"

#include <algorithm>
#include <cstring>
#include <tetwarp/page_lock.hpp>

#include "bench/measure/buffer.hpp"
#include "kernels/exec/staging_ring.cuh"

namespace tetwarp::bench {

RingShape usual_ring() {
  const StagingRing::Shape shape;
  return {shape.slot_bytes, shape.slots, shape.threads};
}

struct CopyWays::State {
  State(std::size_t size, CopyDirection to, const RingShape& shape)
      : bytes(size),
        direction(to),
        ring(0, {.slot_bytes = shape.slot_bytes, .slots = shape.slots, .threads = shape.threads}),
        pageable(size) {
    device.reserve(static_cast<std::int64_t>(size));
    pinned.reserve(static_cast<std::int64_t>(size));
    std::memset(pageable.data(), 1, size);
    std::memset(pinned.view(0).data, 1, size);
    check_cuda(cudaMemset(memory(), 1, size), "cudaMemset");
    check_cuda(cudaDeviceSynchronize(), "cudaDeviceSynchronize");
  }

  std::byte* memory() const { return device.view(0).data; }
  void wait() const { check_cuda(cudaStreamSynchronize(stream), "cudaStreamSynchronize"); }
  void stage(std::byte* host) {
    if (direction == CopyDirection::to_host) {
      ring.download(memory(), host, {bytes, 1, 1, 1}, stream);
    } else {
      ring.upload(host, memory(), bytes, stream);
    }
    wait();
  }
  void copy(std::byte* host) const {
    const bool to_host = direction == CopyDirection::to_host;
    check_cuda(cudaMemcpyAsync(to_host ? host : memory(), to_host ? memory() : host, bytes,
                               to_host ? cudaMemcpyDeviceToHost : cudaMemcpyHostToDevice, stream),
               "cudaMemcpyAsync");
    wait();
  }

  std::size_t bytes;
  CopyDirection direction;
  DeviceStream stream;
  StagingRing ring;
  Buffer pageable;
  PinnedBuffer<std::byte> pinned;
  DeviceBuffer<std::byte> device;
};

CopyWays::CopyWays(std::size_t bytes, CopyDirection direction, const RingShape& shape) {
  check_cuda(cudaSetDevice(0), "cudaSetDevice");
  state_ = std::make_unique<State>(bytes, direction, shape);
}
CopyWays::~CopyWays() = default;

void CopyWays::staged() {
  state_->stage(state_->pageable.data());
}
void CopyWays::by_runtime() {
  state_->copy(state_->pageable.data());
}
void CopyWays::locked() {
  state_->copy(state_->pinned.view(0).data);
}
void CopyWays::staged_untouched() {
  const Buffer fresh(state_->bytes);
  state_->stage(fresh.data());
}
void CopyWays::by_runtime_untouched() {
  const Buffer fresh(state_->bytes);
  state_->copy(fresh.data());
}
void CopyWays::lock() {
  const PageLock lock(state_->pageable.data(), state_->bytes);
  if (!lock.is_locked()) throw CudaError("the pages cannot be locked");
}

bool CopyWays::is_right() {
  State& s = *state_;
  std::byte* const bytes = s.pageable.data();
  const auto number = [](std::size_t b) { return static_cast<std::byte>(b % 251); };
  const CopyDirection asked = s.direction;
  for (std::size_t b = 0; b < s.bytes; ++b) bytes[b] = number(b);
  s.direction = CopyDirection::to_device;
  s.stage(bytes);
  std::memset(bytes, 0, s.bytes);
  s.direction = CopyDirection::to_host;
  s.stage(bytes);
  s.direction = asked;
  for (std::size_t b = 0; b < s.bytes; ++b) {
    if (bytes[b] != number(b)) return false;
  }
  return true;
}

}  // namespace tetwarp::bench
