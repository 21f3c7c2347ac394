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
  /// sum += change[0] rows[0] + change[1] rows[1] + change[2] rows[2], rows of `stride` numbers.
  /// @param size  a multiple of 8
  void (*add_rows)(
      const float* rows, std::int64_t stride, const double* change, std::int64_t size, double* sum);
  /// block[a][b] += sum over parts p and i of rows[p][a][i] columns[place[p] + i][b].
  /// @param rows     [parts][3][3]
  /// @param columns  [places][4], the last of each is not used
  /// @param block    [3][4]
  void (*add_blocks)(const double* rows,
                     const std::int32_t* place,
                     std::int64_t parts,
                     const double* columns,
                     double* block);
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
