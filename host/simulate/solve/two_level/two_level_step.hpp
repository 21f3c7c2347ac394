/// @file two_level_step.hpp
/// A step of a two-level iteration without its contacts.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/solve/two_level/elastic_space.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/step/stepper.hpp"
#include "kernels/body/row_product.hpp"

namespace tetwarp {

/// With M^-1 = omega D^-1, D the diagonal blocks of A, and R A_0^-1 R^T for single elastic bodies.
/// Vectors [rows][3] have the rows of the lists, y what TouchingBlocks adds to them.
class TwoLevelStep {
 public:
  TwoLevelStep(const Model& model, int threads) : model_(model), threads_(threads) {}

  /// Inverts the diagonal blocks.
  /// @param system, lists, elastic  kept by the caller
  /// @param weights                 out: diagonal of A, [rows][3]
  void set(const StepSystem& system,
           const CompliantLists& lists,
           ElasticSpace& elastic,
           std::vector<double>& weights);

  /// D^-1.
  const DiagonalInverse<double>& inverse() const { return diagonal_; }
  /// y = x + M^-1 d, d = force - A x.
  /// @returns d . M^-1 d
  double run(const std::vector<double>& x,
             const std::vector<double>& force,
             std::vector<double>& y);
  /// d of the last run(), [rows][3].
  const std::vector<double>& defect() const { return product_; }
  /// out = A x. @param x, out  [rows][3]
  void multiply(const double* x, double* out) const;
  /// out = M^-1 push. @param push, out  [rows][3]
  void solve(const double* push, double* out) const;
  /// Adds M^-1 J^T (after - before) to the rows of elastic bodies, which sweeps leave as they are.
  /// @param before, after  impulses, [3 contacts]
  void add_elastic(const TouchingBlocks& blocks,
                   const double* before,
                   const double* after,
                   std::vector<double>& y);

 private:
  /// Rows that one task takes; those of the system follow each other, too.
  struct Chunk {
    std::int32_t row_begin = 0, row_end = 0;
    std::int32_t system_row = 0;  ///< of the first one
    bool is_elastic = false;
  };

  void list_chunks();
  void multiply_chunk(const Chunk& chunk, const double* x, double* out) const;
  void solve_chunk(const Chunk& chunk, const double* push, double* out) const;
  void step_chunk(std::int64_t chunk,
                  const std::vector<double>& x,
                  const std::vector<double>& force,
                  std::vector<double>& y);
  double step_elastic(const std::vector<double>& x, std::vector<double>& y);

  const Model& model_;
  int threads_;
  const StepSystem* system_ = nullptr;
  const CompliantLists* lists_ = nullptr;
  ElasticSpace* elastic_ = nullptr;
  std::int64_t version_ = 0;  ///< of the lists of the chunks
  std::vector<Chunk> chunks_;
  std::vector<double> inverse_;
  DiagonalInverse<double> diagonal_;
  std::vector<double> product_;                    ///< [rows][3] A x, then d
  std::vector<double> pull_, moved_;               ///< [rows][3] J^T r and M^-1 of elastic bodies
  std::vector<double> squares_, elastic_squares_;  ///< [chunks], [bodies] parts of d . M^-1 d
};

}  // namespace tetwarp
