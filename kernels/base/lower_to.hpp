/// @file lower_to.hpp
/// Atomic minimum of integers: the final value does not depend on the order of threads.
#pragma once
#include <type_traits>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// *value = min(*value, other).
/// @tparam Integer  of 32 bits
template <class Integer>
TETWARP_HD void lower_to(Integer* value, std::type_identity_t<Integer> other) {
  static_assert(sizeof(Integer) == 4);
#if defined(__CUDA_ARCH__)
  atomicMin(value, other);
#else
  Integer old = __atomic_load_n(value, __ATOMIC_RELAXED);
  while (other < old && !__atomic_compare_exchange_n(value, &old, other, true, __ATOMIC_RELAXED,
                                                     __ATOMIC_RELAXED)) {
  }
#endif
}

}  // namespace tetwarp
