/// @file async_copy.cuh
/// Copies from global to shared memory that a thread begins and later waits for. Devices from sm_80
/// on copy without registers while the thread goes on; older ones copy at once.
#pragma once
#if defined(__CUDACC__)
#include <cuda_pipeline.h>
#endif

#include "kernels/exec/launch.hpp"

namespace tetwarp {

constexpr int copy_bytes = 16;  ///< of one copy, to which both addresses are aligned

/// Begins to copy from global to shared memory. The source must not change, and the copy must not
/// be read, before wait_for_copies().
__device__ __forceinline__ void begin_copy(void* to_shared, const void* from) {
  __pipeline_memcpy_async(to_shared, from, copy_bytes);
}

/// Waits for all copies that this thread has begun. Other threads read them after a barrier.
__device__ __forceinline__ void wait_for_copies() {
  __pipeline_commit();
  __pipeline_wait_prior(0);
}

}  // namespace tetwarp
