/// @file mul_add.hpp
/// Products and sums whose rounding is the same in all kernels.
#pragma once
#include "kernels/base/hd.hpp"

namespace tetwarp {

/// a * b + c, on a device always rounded once, so that all kernels compute the same bits; as on the
/// host where the build asks for it (TETWARP_STRICT_FP).
template <class Real>
TETWARP_HD Real mul_add(Real a, Real b, Real c) {
#if defined(__CUDA_ARCH__) && !defined(TETWARP_STRICT_FP)
  return fma(a, b, c);
#else
  return a * b + c;
#endif
}

}  // namespace tetwarp
