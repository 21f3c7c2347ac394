/// @file vector_stages_avx512.cpp
/// Vectors of eight numbers, for processors with AVX-512.
#include "host/simulate/step/cpu/vector_stages-inl.hpp"

namespace tetwarp {

const VectorStages vector_stages_avx512 = vector_stages_of<8>("avx512");

}  // namespace tetwarp
