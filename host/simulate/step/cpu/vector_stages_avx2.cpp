/// @file vector_stages_avx2.cpp
#include "host/simulate/step/cpu/vector_stages-inl.hpp"

namespace tetwarp {

const VectorStages vector_stages_avx2 = vector_stages_of<4>("avx2");

}  // namespace tetwarp
