/// @file vector_stages_avx512.cpp
#include "host/simulate/step/cpu/vector_stages-inl.hpp"

namespace tetwarp {

const VectorStages vector_stages_avx512 = vector_stages_of<8>("avx512");

}  // namespace tetwarp
