/// @file vector_stages.hpp
/// Stages of a step in vectors, compiled for several instruction sets. All give the same bits.
#pragma once
#include <cstdint>

#include "kernels/body/block_assemble.hpp"
#include "kernels/body/island_cg.hpp"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {

/// L of L L^T in blocks of 3 x 3, a column at a time.
struct BlockFactor {
  View<const std::int32_t> start;  ///< [columns + 1]
  View<const std::int32_t> row;    ///< [entries] below the diagonal
  View<const float> block;         ///< [entries][9] columns first, and one number beyond the last
  View<const float> diagonal;      ///< [columns][6] inverses of the lower triangles, rows first
};

/// L and U^T of L U in blocks of 3 x 3, a column of either at a time, from the diagonal on. Columns
/// of a block have four numbers, the last of each is not used.
struct BlockPairFactor {
  View<const std::int32_t> row;    ///< [entries]
  View<const std::int64_t> start;  ///< [columns + 1] of entries
  const double* lower;             ///< [entries][12]
  const double* upper;             ///< the same; of U with its diagonal
  const double* inverse;           ///< [columns][9] of the pivots, row by row
};

/// Tetrahedra of a model, one array entry per tetrahedron.
struct TetShapes {
  View<const std::int32_t> nodes;  ///< [tets][4]
  View<const double> gradient;     ///< [tets][9] g_1, g_2, g_3 [1/m]
  View<const double> volume;       ///< [tets] [m^3]
  View<const double> lambda, mu;   ///< [tets] [Pa]
  View<const double> position;     ///< [nodes][3]
};
struct TetSums {
  double energy = 0;          ///< [J]
  std::int64_t inverted = 0;  ///< of negative volume
};

/// Each function does the indices [begin, end) of its stage.
struct VectorStages {
  const char* name;  ///< of the instruction set
  void (*tet_forces)(const TetForceOp& op, std::int64_t begin, std::int64_t end);
  /// @returns sums in the order of indices
  TetSums (*tet_energies)(const TetShapes& tets, std::int64_t begin, std::int64_t end);
  void (*assemble)(const BlockAssembleOp& op, std::int64_t begin, std::int64_t end);
  PlainSums<1> (*product)(const GradientArrays<double>& a, std::int64_t begin, std::int64_t end);
  PlainSums<1> (*product_float)(const GradientArrays<float>& a,
                                std::int64_t begin,
                                std::int64_t end);
  /// sum += change[0] rows[0] + change[1] rows[1] + change[2] rows[2], rows of `stride` numbers.
  /// @param size  a multiple of 8
  void (*add_rows)(
      const float* rows, std::int64_t stride, const double* change, std::int64_t size, double* sum);
  /// The same in float32.
  void (*add_rows_float)(
      const float* rows, std::int64_t stride, const float* change, std::int64_t size, float* sum);
  /// block[a][b] += sum over parts p and i of rows[p][a][i] columns[place[p] + i][b].
  /// @param rows     [parts][3][3]
  /// @param columns  [places][8]
  /// @param block    [3][8]
  void (*add_blocks)(const float* rows,
                     const std::int32_t* place,
                     std::int64_t parts,
                     const float* columns,
                     float* block);
  /// w = L^-T L^-1 w. @param w  [columns][4], the last of each is not used
  void (*substitute)(const BlockFactor& l, double* w);
  /// w = U^-1 L^-1 w for four vectors at once. @param w  [columns][3][4]
  void (*substitute_four)(const BlockPairFactor& lu, double* w);
  /// out[slot[rows[e]]] -= blocks[e] factor^T of 3x3 blocks, whose three columns have four numbers,
  /// the last of each not used.
  void (*subtract_products)(const double* blocks,
                            const std::int32_t* rows,
                            std::int64_t count,
                            const std::int32_t* slot,
                            const double* factor,
                            double* out);
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
