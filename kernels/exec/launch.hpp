/// @file launch.hpp
/// Launches kernels: on a GPU if compiled by nvcc, else on the CPU by the emulation. `.cuh` files
/// include this instead of CUDA's headers.
#pragma once
#include <cstddef>

#if defined(__CUDACC__)
#include <cuda_runtime.h>

#include <string>
#include <tetwarp/error.hpp>
#include <tuple>
#include <type_traits>
#else
#include "kernels/emu/runtime.hpp"
#endif

namespace tetwarp {

/// Dynamic shared memory of the running block, aligned to 16 bytes.
template <class T>
__device__ __forceinline__ T* dynamic_shared() {
#if defined(__CUDACC__)
  extern __shared__ __align__(16) unsigned char tetwarp_dynamic_shared[];
  return reinterpret_cast<T*>(tetwarp_dynamic_shared);
#else
  return static_cast<T*>(simt::Block::current().shared());
#endif
}

/// Launches `kernel(args...)`.
///
/// @param stream        stream to enqueue on; null in the emulation runs the kernel immediately
/// @param grid          number of blocks, no extent zero
/// @param block         threads per block
/// @param shared_bytes  dynamic shared memory of a block, at most 48 KiB
/// @throws CudaError if the launch fails, simt::Fault if the emulation finds an error in the kernel
template <class... Parameters, class... Args>
void launch(cudaStream_t stream,
            void (*kernel)(Parameters...),
            dim3 grid,
            dim3 block,
            std::size_t shared_bytes,
            const Args&... args) {
#if defined(__CUDACC__)
  // Not <<<>>>, whose errors can only be read as the last error, that of an earlier call included.
  std::tuple<std::remove_const_t<Parameters>...> values(args...);
  const cudaError_t status = std::apply(
      [&](auto&... value) {
        void* addresses[] = {&value...};
        return cudaLaunchKernel(reinterpret_cast<const void*>(kernel), grid, block, addresses,
                                shared_bytes, stream);
      },
      values);
  if (status != cudaSuccess) {
    cudaGetLastError();  // reported here
    throw CudaError(std::string("kernel launch: ") + cudaGetErrorString(status));
  }
#else
  simt::launch_on(stream, kernel, grid, block, shared_bytes, args...);
#endif
}

}  // namespace tetwarp
