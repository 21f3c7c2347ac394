/// @file rest_matrix.hpp
/// The system matrix of one elastic body at rest.
#pragma once
#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// A_0 of a step: entries between the nodes with unknowns of one body.
class RestMatrix {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// Masses, damping and springs. @param time_step  [s]
  RestMatrix(const Model& model, std::int32_t body, double time_step);

  /// Nodes with unknowns.
  std::int32_t count() const { return count_; }
  /// Adds stiffness and damping of a tetrahedron.
  void add_tet(std::size_t t, double time_step);
  /// The lower triangle with its nodes in the order of least fill.
  /// @param place  out, [nodes] place of each
  Matrix ordered(std::vector<std::int32_t>& place) const;

 private:
  std::int32_t slot_of(std::int32_t node) const;
  void add(std::int32_t a, std::int32_t b, const double* block);
  void add_scalar(std::int32_t a, std::int32_t b, double value);
  void add_masses(double time_step);
  bool is_elsewhere(const ModelPoint& point) const;
  void add_springs(double time_step);

  const Model& model_;
  std::int32_t begin_, end_, count_ = 0;
  std::vector<std::int32_t> slot_;  ///< [nodes of the body] place among those with unknowns, or -1
  std::map<std::array<std::int32_t, 2>, std::array<double, 9>> blocks_;
};

}  // namespace tetwarp
