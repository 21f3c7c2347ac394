/// @file emulated_backend.cpp
/// Back end cuda on the emulated device: executor, pipeline and kernels are those of the real one;
/// scan, selection and sort use the standard library in place of CUB.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>

#include "host/base/warp_backend.hpp"

#include "host/warp/cuda/cell_raster_cuda.cuh"

namespace tetwarp {
namespace {
/// Work on a stream other than kernels.
template <class Work>
void enqueue(cudaStream_t stream, Work&& work) {
  const std::lock_guard guard(simt::Device::only().lock);
  simt::Device::only().note(simt::ApiCall::launch);
  simt::Device::only().stream(stream).enqueue(std::forward<Work>(work));
  simt::Device::only().run_eager();
}

/// Like CUB's, the primitives take scratch memory that grows with their input.
void take_scratch(DeviceBuffer<std::byte>& scratch, std::int64_t count) {
  scratch.reserve(256 + count / 32);
}
}  // namespace

void cuda_reserve_scan(DeviceBuffer<std::byte>& scratch, std::int64_t count) {
  take_scratch(scratch, count);
}

void cuda_exclusive_scan(cudaStream_t stream,
                         DeviceBuffer<std::byte>& scratch,
                         View<std::int64_t> values) {
  take_scratch(scratch, values.size);
  enqueue(stream, [values] {
    std::exclusive_scan(values.data, values.data + values.size, values.data, std::int64_t{0});
  });
}

void cuda_select_valid(cudaStream_t stream,
                       DeviceBuffer<std::byte>& scratch,
                       View<const CellPair> candidates,
                       View<CellPair> pairs,
                       std::int64_t* pair_count) {
  take_scratch(scratch, candidates.size);
  enqueue(stream, [=] {
    CellPair* const end = std::copy_if(candidates.data, candidates.data + candidates.size,
                                       pairs.data, [](CellPair p) { return p != rejected_pair; });
    *pair_count = end - pairs.data;
  });
}

void cuda_sort_pairs(cudaStream_t stream,
                     DeviceBuffer<std::byte>& scratch,
                     View<CellPair> pairs,
                     View<CellPair> other,
                     int cell_bits) {
  take_scratch(scratch, pairs.size);
  enqueue(stream, [=] {
    std::copy_n(pairs.data, pairs.size, other.data);
    const CellPair mask = ((CellPair{1} << cell_bits) - 1) << 32;
    std::stable_sort(other.data, other.data + other.size,
                     [mask](CellPair a, CellPair b) { return (a & mask) < (b & mask); });
    std::copy_n(other.data, other.size, pairs.data);
  });
}

BackendStatus cuda_status(int device) {
  if (device == 0) return {Backend::cuda, true, "emulation", ""};
  return {Backend::cuda, false, "", "no device " + std::to_string(device) + ", there are 1"};
}

double free_device_memory(int device) {
  return device == 0 ? 0x1p40 : 0;
}

bool cuda_lock_pages(void* data, std::size_t bytes) {
  if (cudaHostRegister(data, bytes, cudaHostRegisterPortable) == cudaSuccess) return true;
  cudaGetLastError();  // leaves no error behind for the next call
  return false;
}

void cuda_unlock_pages(void* data) {
  cudaHostUnregister(data);
}

std::unique_ptr<WarpBackend> make_cuda_backend(const WarpPlan& plan) {
  const DeviceScope scope(plan.options.device);
  return std::make_unique<WarpPipeline<CudaExec>>(plan, CudaExec(plan.options.device));
}

}  // namespace tetwarp
