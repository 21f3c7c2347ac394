/// @file vector_stages_avx2.cpp
/// Vectors of four numbers, for processors with AVX2.
#include "host/simulate/step/cpu/vector_stages-inl.hpp"

namespace tetwarp {

const VectorStages vector_stages_avx2 = vector_stages_of<4>("avx2");

}  // namespace tetwarp
