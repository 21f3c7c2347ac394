/// @file hd.hpp
/// Functions that run on host and device, and the few operations whose rounding must not depend on
/// where they run.
#pragma once
#include <math.h>  // not <cmath>: floor() and others for float, in the global namespace too

// TETWARP_HD: compiled for host and device, always inlined. TETWARP_HD_RARE: the same, never
// inlined, so that its registers do not count for a hot loop that rarely calls it.
// TETWARP_ANY_EXEC: compiled for both, inlining left to the compiler.
#if defined(__CUDACC__)
#define TETWARP_HD __host__ __device__ __forceinline__
#define TETWARP_HD_RARE __host__ __device__ __noinline__ inline
#define TETWARP_ANY_EXEC __host__ __device__
#else
#define TETWARP_HD inline __attribute__((always_inline))
#define TETWARP_HD_RARE inline __attribute__((noinline))
#define TETWARP_ANY_EXEC
#endif

namespace tetwarp {

/// a * b, rounded once: never fused into a neighboring addition.
TETWARP_HD double mul_rn(double a, double b) {
#if defined(__CUDA_ARCH__)
  return __dmul_rn(a, b);
#elif defined(__FMA__) && !defined(__clang__)
  return __builtin_assoc_barrier(a * b);  // the emulated device may be compiled with contraction
#else
  return a * b;  // the build turns contraction off on the host
#endif
}

/// a + b, rounded once: never fused with a neighboring product.
TETWARP_HD double add_rn(double a, double b) {
#if defined(__CUDA_ARCH__)
  return __dadd_rn(a, b);
#else
  return a + b;
#endif
}

template <class T>
TETWARP_HD T min_of(T a, T b) {
  return b < a ? b : a;
}

/// The smaller of two numbers; if one of them is NaN, the other.
TETWARP_HD float smaller_of(float a, float b) {
#if defined(__CUDA_ARCH__)
  return fminf(a, b);  // one instruction; a comparison and a choice are two
#else
  return b < a || a != a ? b : a;
#endif
}

/// The larger of two numbers; if one of them is NaN, the other.
TETWARP_HD float larger_of(float a, float b) {
#if defined(__CUDA_ARCH__)
  return fmaxf(a, b);
#else
  return b > a || a != a ? b : a;
#endif
}

template <class T>
TETWARP_HD T max_of(T a, T b) {
  return a < b ? b : a;
}

template <class T>
TETWARP_HD T square_of(T x) {
  return x * x;
}

}  // namespace tetwarp
