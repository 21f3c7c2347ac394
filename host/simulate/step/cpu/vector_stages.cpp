/// @file vector_stages.cpp
/// Chooses the widest instruction set that the processor has.
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {

const VectorStages& vector_stages() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq")) {
    return vector_stages_avx512;
  }
  if (__builtin_cpu_supports("avx2")) return vector_stages_avx2;
#endif
  return vector_stages_base;
}

void nearest_rotation(const double* gradient, double* rotation) {
  rotation_by_svd(gradient, rotation);
}

}  // namespace tetwarp
