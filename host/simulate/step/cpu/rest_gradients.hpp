/// @file rest_gradients.hpp
/// RestGradients: conjugate gradients for elastic bodies whose systems block Jacobi solves slowly.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/simulate/step/cpu/rest_factors.hpp"
#include "kernels/body/island_cg.hpp"

namespace tetwarp {

/// Preconditioner R A_0^-1 R^T of each body, A_0 its system at rest and R its mean rotation: a body
/// that bends little takes about ten iterations, however stiff it is.
class RestGradients {
 public:
  /// A body of an island, in its step.
  struct TurnedFactor {
    RestFactor* factor;
    std::array<double, 9> rotation;
  };

  /// @param factors  shared with the solution of contacts, or null: own ones
  RestGradients(const Model& model, std::shared_ptr<RestFactors> factors);

  /// Call before the solves of a step. @param position  of all nodes, [nodes][3], until they end
  void begin(double time_step, const double* position);
  /// Whether solve() takes a coupling island.
  bool is_possible(std::int32_t island) const {
    return !factors_->bodies_of_island(island).empty();
  }
  /// Improves a.x on the rows of an island, until |r|_{D^-1} is half the tolerance of |b|_{D^-1} by
  /// the running residual, for the given and at most some tens of iterations. Different islands may
  /// be solved by different threads. @returns the iterations
  std::int64_t solve(const GradientArrays<double>& a,
                     std::int32_t island,
                     std::int64_t begin,
                     std::int64_t end,
                     const GradientOptions& options);

 private:
  std::shared_ptr<RestFactors> factors_;
  std::vector<std::vector<TurnedFactor>> turned_;  ///< [coupling islands] of the last solves
  const double* position_ = nullptr;
};

}  // namespace tetwarp
