/// @file two_level_step.hpp
/// A step of a two-level iteration without its contacts.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/solve/two_level/elastic_space.hpp"
#include "host/simulate/solve/two_level/taken_islands.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "kernels/body/row_product.hpp"

namespace tetwarp {

/// With M^-1 = omega D^-1, D the diagonal blocks of A, and R A_0^-1 R^T for single elastic bodies.
class TwoLevelStep {
 public:
  /// @param relaxation  omega of islands with several bodies; of single rigid bodies it is 1
  TwoLevelStep(const Model& model, double relaxation, int threads)
      : model_(model), relaxation_(relaxation), threads_(threads) {}

  /// Inverts the diagonal blocks.
  /// @param islands, elastic  kept by the caller
  /// @param weights           out: diagonal of A, [rows][3]; 0 outside of the islands
  void set(const StepSystem& system,
           const TakenIslands& islands,
           ElasticSpace& elastic,
           std::vector<double>& weights);

  /// D^-1.
  const DiagonalInverse<double>& inverse() const { return diagonal_; }
  /// Numbers of x from the first island's first row up to the last one's end. @pre !is_empty()
  std::int64_t begin() const { return 3 * std::int64_t{chunks_.front().row_begin}; }
  std::int64_t end() const { return 3 * std::int64_t{chunks_.back().row_end}; }
  /// Whether there are no islands.
  bool is_empty() const { return chunks_.empty(); }
  /// Calls visit(row) for the rows of all islands.
  template <class Visit>
  void for_each_row(const Visit& visit) const {
    for (const Chunk& chunk : chunks_) {
      for (std::int32_t row = chunk.row_begin; row < chunk.row_end; ++row) visit(row);
    }
  }

  /// y = x + M^-1 d, d = force - A x.
  /// @param x, force  [rows][3]
  /// @param y         out, as TouchingBlocks has it
  /// @returns d . M^-1 d
  double run(const StepSystem& system,
             const std::vector<double>& x,
             const std::vector<double>& force,
             std::vector<double>& y);
  /// d of the last run(), [rows][3].
  const std::vector<double>& defect() const { return product_; }
  /// Adds M^-1 J^T (after - before) to the rows of elastic bodies, which sweeps leave as they are.
  /// @param before, after  impulses, [3 contacts]
  void add_elastic(const TouchingBlocks& blocks,
                   const double* before,
                   const double* after,
                   std::vector<double>& y);

 private:
  /// Rows of an island that one task takes.
  struct Chunk {
    std::int32_t row_begin = 0, row_end = 0;
    std::int32_t island = 0;  ///< in TakenIslands::list()
  };

  void list_chunks(const SystemRows& rows);
  void step_chunk(std::int64_t chunk,
                  const std::vector<double>& x,
                  const std::vector<double>& force,
                  std::vector<double>& y);
  double step_elastic(const std::vector<double>& x, std::vector<double>& y);

  const Model& model_;
  double relaxation_;
  int threads_;
  const TakenIslands* islands_ = nullptr;
  ElasticSpace* elastic_ = nullptr;
  std::vector<Chunk> chunks_;
  std::vector<double> inverse_;
  DiagonalInverse<double> diagonal_;
  std::vector<double> product_;                    ///< [rows][3] A x, then d
  std::vector<double> pull_, moved_;               ///< [rows][3] J^T r and M^-1 of elastic bodies
  std::vector<double> squares_, elastic_squares_;  ///< [chunks], [bodies] parts of d . M^-1 d
};

}  // namespace tetwarp
