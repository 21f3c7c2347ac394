/// @file launch.hpp
/// Launches kernels: on a GPU if compiled by nvcc, else on an emulated device, whose
/// `cuda_runtime.h` the tests provide. `.cuh` files include this instead of CUDA's headers.
#pragma once
#include <cuda_runtime.h>

#include <cstddef>
#include <tuple>
#include <type_traits>

#if defined(__CUDACC__)
#include <cooperative_groups.h>

#include <string>
#include <tetwarp/error.hpp>
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

/// Waits until all threads of the grid have called it; what they wrote before is visible after it.
/// @pre the kernel was launched by launch_cooperative()
__device__ __forceinline__ void grid_sync() {
#if defined(__CUDACC__)
  cooperative_groups::this_grid().sync();
#else
  simt::Block::current().wait_for_grid(__builtin_LINE());
#endif
}

#if defined(__CUDACC__)
/// Calls start(kernel, array of the addresses of its arguments), which launches it.
/// @throws CudaError if that fails
template <class... Parameters, class Start, class... Args>
void launch_by(const Start& start, void (*kernel)(Parameters...), const Args&... args) {
  // Not <<<>>>, whose errors can only be read as the last error, that of an earlier call included.
  std::tuple<std::remove_const_t<Parameters>...> values(args...);
  const cudaError_t status = std::apply(
      [&](auto&... value) {
        void* addresses[] = {&value...};
        return start(reinterpret_cast<const void*>(kernel), addresses);
      },
      values);
  if (status != cudaSuccess) {
    cudaGetLastError();  // reported here
    throw CudaError(std::string("kernel launch: ") + cudaGetErrorString(status));
  }
}
#endif

/// Launches `kernel(args...)`.
///
/// @param stream        stream to enqueue on; null in the emulation runs the kernel immediately
/// @param grid          number of blocks, no extent zero
/// @param block         threads per block
/// @param shared_bytes  dynamic shared memory of a block, at most 48 KiB unless
///                      cudaFuncSetAttribute() allowed more
/// @throws CudaError if the launch fails, simt::Fault if the emulation finds an error in the kernel
template <class... Parameters, class... Args>
void launch(cudaStream_t stream,
            void (*kernel)(Parameters...),
            dim3 grid,
            dim3 block,
            std::size_t shared_bytes,
            const Args&... args) {
#if defined(__CUDACC__)
  launch_by(
      [&](const void* start, void** addresses) {
        return cudaLaunchKernel(start, grid, block, addresses, shared_bytes, stream);
      },
      kernel, args...);
#else
  simt::launch_on(stream, kernel, grid, block, shared_bytes, args...);
#endif
}

/// A kernel as a node of a graph.
/// @param values     its arguments
/// @param addresses  of each of them; must stay valid until the node is made
template <class... Parameters>
cudaKernelNodeParams node_params(void (*kernel)(Parameters...),
                                 dim3 grid,
                                 dim3 block,
                                 std::size_t shared_bytes,
                                 const std::tuple<std::remove_const_t<Parameters>...>& values,
                                 void** addresses) {
  cudaKernelNodeParams parameters = {};
  parameters.func = reinterpret_cast<void*>(kernel);
  parameters.gridDim = grid;
  parameters.blockDim = block;
  parameters.sharedMemBytes = static_cast<unsigned>(shared_bytes);
  parameters.kernelParams = addresses;
#if !defined(__CUDACC__)
  parameters.run = [=] {
    std::apply(
        [&](const auto&... value) { simt::launch(kernel, grid, block, shared_bytes, value...); },
        values);
  };
#else
  static_cast<void>(values);
#endif
  return parameters;
}

/// As launch(), of a kernel that calls grid_sync(): all its blocks are resident together.
template <class... Parameters, class... Args>
void launch_cooperative(cudaStream_t stream,
                        void (*kernel)(Parameters...),
                        dim3 grid,
                        dim3 block,
                        std::size_t shared_bytes,
                        const Args&... args) {
#if defined(__CUDACC__)
  launch_by(
      [&](const void* start, void** addresses) {
        return cudaLaunchCooperativeKernel(start, grid, block, addresses, shared_bytes, stream);
      },
      kernel, args...);
#else
  simt::launch_cooperative_on(stream, kernel, grid, block, shared_bytes, args...);
#endif
}

}  // namespace tetwarp
