/// @file emulated_primitives.cpp
/// Scan and sort of the emulated device: the standard library in place of CUB.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <numeric>
#include <utility>

#include "kernels/exec/exec_cuda.cuh"

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

void cuda_exclusive_scan(cudaStream_t stream,
                         DeviceBuffer<std::byte>& scratch,
                         View<std::int64_t> values) {
  take_scratch(scratch, values.size);
  enqueue(stream, [values] {
    std::exclusive_scan(values.data, values.data + values.size, values.data, std::int64_t{0});
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

}  // namespace tetwarp
