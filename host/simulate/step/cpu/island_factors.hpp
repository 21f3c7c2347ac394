/// @file island_factors.hpp
/// IslandFactors: the system of a coupling island solved by its factors.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "host/simulate/step/cpu/row_range_lu.hpp"
#include "kernels/body/island_cg.hpp"

namespace tetwarp {

/// For narrow cloth and chains, whose systems block Jacobi solves slowly and whose factors have few
/// entries.
class IslandFactors {
 public:
  /// Iterations of conjugate gradients that have as many multiplications as a factorization. The
  /// pattern of the rows is found at the first call; islands of few or of very many rows have no
  /// factors, and all iterations are worth it.
  std::int64_t find_worth(const SystemRows& rows, std::int64_t begin, std::int64_t end);
  /// @pre find_worth()
  bool is_possible() const { return lu_ != nullptr; }
  /// Whether a factorization takes no longer than iterations usually do.
  bool are_quick() const { return is_possible() && worth_ <= usual_iterations; }
  /// a.x = A^-1 b on the rows of the island; they stay as they are if A has no factors.
  void solve(const GradientArrays<double>& a, std::int64_t begin);
  /// What solve() has made since forget(), or null.
  RowRangeLu* made() { return is_made_ ? lu_.get() : nullptr; }
  void forget() { is_made_ = false; }

 private:
  static constexpr std::int64_t usual_iterations = 40;

  std::unique_ptr<RowRangeLu> lu_;  ///< null: not possible
  std::int64_t row_count_ = 0;      ///< of the pattern
  std::int64_t worth_ = 0;
  bool is_made_ = false;
  std::vector<double> x_;
};

}  // namespace tetwarp
