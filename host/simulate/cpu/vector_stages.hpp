/// @file vector_stages.hpp
/// Stages of a step in vectors, compiled for several instruction sets. All give the same bits.
#pragma once
#include <cstdint>

#include "kernels/body/block_assemble.hpp"
#include "kernels/body/island_cg.hpp"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {

/// Each function does the indices [begin, end) of its stage.
struct VectorStages {
  const char* name;  ///< of the instruction set
  void (*tet_forces)(const TetForceBody& body, std::int64_t begin, std::int64_t end);
  void (*assemble)(const BlockAssembleBody& body, std::int64_t begin, std::int64_t end);
  PlainSums<1> (*product)(const GradientArrays<double>& a, std::int64_t begin, std::int64_t end);
  PlainSums<1> (*product_float)(const GradientArrays<float>& a,
                                std::int64_t begin,
                                std::int64_t end);
};

/// The widest that this processor has.
const VectorStages& vector_stages();

// Compiled with the options of their instruction sets.
extern const VectorStages vector_stages_base;
#if defined(__x86_64__)
extern const VectorStages vector_stages_avx2;
extern const VectorStages vector_stages_avx512;
#endif

/// rotation_by_svd(), compiled for every processor.
void nearest_rotation(const double* gradient, double* rotation);

}  // namespace tetwarp
