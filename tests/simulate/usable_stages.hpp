/// @file usable_stages.hpp
/// The vector stages of all instruction sets that this processor has.
#pragma once
#include <string>
#include <vector>

#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp::test {

inline std::vector<const VectorStages*> usable_stages() {
  std::vector<const VectorStages*> stages = {&vector_stages_base};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) stages.push_back(&vector_stages_avx2);
#endif
  if (&vector_stages() != stages.back()) stages.push_back(&vector_stages());
  return stages;
}

/// Those of one instruction set; null if the processor lacks it.
inline const VectorStages* usable_stages(const std::string& name) {
  for (const VectorStages* stages : usable_stages()) {
    if (stages->name == name) return stages;
  }
  return nullptr;
}

}  // namespace tetwarp::test
