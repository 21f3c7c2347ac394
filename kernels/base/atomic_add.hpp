/// @file atomic_add.hpp
/// Atomic addition to integer counters: the sum does not depend on the order of threads.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

TETWARP_HD void atomic_add(std::int64_t* counter, std::int64_t value) {
#if defined(__CUDA_ARCH__)
  atomicAdd(reinterpret_cast<unsigned long long*>(counter), static_cast<unsigned long long>(value));
#else
  __atomic_fetch_add(counter, value, __ATOMIC_RELAXED);
#endif
}

TETWARP_HD void atomic_add(std::int32_t* counter, std::int32_t value) {
#if defined(__CUDA_ARCH__)
  atomicAdd(counter, value);
#else
  __atomic_fetch_add(counter, value, __ATOMIC_RELAXED);
#endif
}

/// Adds 1 and returns the value before: a number of its own for every caller, in no fixed order.
TETWARP_HD std::uint32_t atomic_next(std::uint32_t* counter) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(counter, 1u);
#else
  return __atomic_fetch_add(counter, 1u, __ATOMIC_RELAXED);
#endif
}

}  // namespace tetwarp
