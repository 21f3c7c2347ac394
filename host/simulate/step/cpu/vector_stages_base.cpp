/// @file vector_stages_base.cpp
/// Vectors of two numbers, which every supported processor has.
#include "host/simulate/step/cpu/vector_stages-inl.hpp"

namespace tetwarp {

const VectorStages vector_stages_base = vector_stages_of<2>("base");

}  // namespace tetwarp
