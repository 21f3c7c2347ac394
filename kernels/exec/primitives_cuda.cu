/// @file primitives_cuda.cu
/// Scan and sort by CUB. The only file that includes CUB, which takes 12 s to compile
/// per architecture.
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <limits>
#include <string>

#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {
namespace {
/// Makes the two calls that CUB needs: call(null, bytes) for the scratch size, and the actual one.
template <class Call>
void with_scratch(DeviceBuffer<std::byte>& scratch, const char* name, Call&& call) {
  std::size_t bytes = 0;
  check_cuda(call(nullptr, bytes), name);
  scratch.reserve(static_cast<std::int64_t>(bytes));
  check_cuda(call(scratch.view(0).data, bytes), name);
}

/// The number of items for a call of CUB. Before version 3.0 some calls take an int.
/// @throws CudaError  that version cannot handle so many
std::int64_t item_count(std::int64_t count) {
#if CUB_VERSION < 300000
  if (count > std::numeric_limits<int>::max()) {
    throw CudaError(std::to_string(count) +
                    " pairs of cells and tetrahedra; more than 2^31-1 need CUDA 13: use smaller "
                    "regions or a smaller memory limit");
  }
#endif
  return count;
}
}  // namespace

void cuda_exclusive_scan(cudaStream_t stream,
                         DeviceBuffer<std::byte>& scratch,
                         View<std::int64_t> values) {
  with_scratch(scratch, "cub::DeviceScan::ExclusiveSum", [&](void* memory, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(memory, bytes, values.data, values.data,
                                         item_count(values.size), stream);
  });
}

void cuda_sort_pairs(cudaStream_t stream,
                     DeviceBuffer<std::byte>& scratch,
                     View<CellPair> pairs,
                     View<CellPair> other,
                     int cell_bits) {
  cub::DoubleBuffer<CellPair> keys(pairs.data, other.data);
  with_scratch(scratch, "cub::DeviceRadixSort::SortKeys", [&](void* memory, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortKeys(memory, bytes, keys, item_count(pairs.size), 32,
                                          32 + cell_bits, stream);
  });
  if (keys.Current() != pairs.data) {
    check_cuda(cudaMemcpyAsync(pairs.data, keys.Current(),
                               static_cast<std::size_t>(pairs.size) * sizeof(CellPair),
                               cudaMemcpyDeviceToDevice, stream),
               "cudaMemcpyAsync on device");
  }
}

}  // namespace tetwarp
