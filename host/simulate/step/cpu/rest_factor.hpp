/// @file rest_factor.hpp
/// A factor of the system matrix of one elastic body at rest. Turned by the mean rotation of the
/// body it is near the matrix of a step, as long as the body bends little.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// L L^T = A_0, the mass, stiffness, damping and springs of a body in the frame of its rest shape.
/// Blocks are of nodes with unknowns, in the order of the model. Numbers of L are rounded to
/// float32: L is the exact factor of a symmetric positive definite matrix near A_0.
class RestFactor {
 public:
  /// Whether a body is one of tetrahedra alone and has a factor of moderate size.
  static bool is_possible(const Model& model, std::int32_t body);

  RestFactor(const Model& model, std::int32_t body, double time_step);

  std::int32_t node_count() const { return static_cast<std::int32_t>(order_.size()); }
  /// out = R A_0^-1 R^T push, [nodes][3] each. @param rotation  R, rows first
  void solve_turned(const std::array<double, 9>& rotation, const double* push, double* out);
  /// The columns of A_0^-1 of a node, [3][nodes][3], rounded; kept once found.
  const float* columns(std::int32_t node);
  /// All of A_0^-1, as columns() of all nodes; not kept.
  void inverse(std::vector<float>& out);
  /// The rotation of the mean of the deformation gradients, rows first: that of
  /// sum_n x_n (sum_t V_t g_tn)^T.
  /// @param position  of all nodes of the model, [nodes][3]
  std::array<double, 9> mean_rotation(const double* position) const;

 private:
  /// What the place of a node adds to the integral of the deformation gradient.
  struct NodeGradient {
    std::int32_t node = 0;  ///< of the model
    Point3 sum{0, 0, 0};    ///< of volumes times gradients of its shape functions [m^2]
  };

  void substitute();  ///< work_ = A_0^-1 work_, in the order of L
  void find_columns(std::int32_t node, float* out);
  void set_gradients(const Model& model, std::int32_t body, const std::vector<std::size_t>& tets);

  std::vector<NodeGradient> gradients_;
  std::vector<std::int32_t> order_;        ///< [nodes] place in L
  std::vector<std::int32_t> start_, row_;  ///< of BlockFactor
  std::vector<float> block_, diagonal_;    ///< of BlockFactor
  std::vector<std::int32_t> column_of_;    ///< [nodes] place in columns_, or -1
  std::vector<float> columns_;             ///< [found][3][nodes][3]
  std::vector<double> work_;               ///< [nodes][4]
};

}  // namespace tetwarp
