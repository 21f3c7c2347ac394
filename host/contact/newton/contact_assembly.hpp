/// @file contact_assembly.hpp
/// Sums A + J^T G J with a block diagonal G that changes from step to step.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

namespace tetwarp {

/// The pattern of A + J^T G J, and where each contact adds to it: a sum allocates nothing.
///
/// Memory: the pattern, and 4 bytes per pair of dofs that one contact moves.
class ContactAssembly {
 public:
  ContactAssembly() = default;

  /// @param system    A, by columns
  /// @param jacobian  J, by columns; three rows per contact
  ContactAssembly(const Eigen::SparseMatrix<double>& system,
                  const Eigen::SparseMatrix<double>& jacobian);

  /// The sum, kept until the next call.
  /// @param response  blocks of G, [contacts]
  const Eigen::SparseMatrix<double>& sum(const std::vector<Eigen::Matrix3d>& response);

 private:
  using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  std::vector<Columns> jacobian_;       ///< of each contact, only the columns of its dofs
  std::vector<std::int32_t> place_;     ///< in the values of the sum; contact by contact, column by
                                        ///< column of the pairs of its dofs
  Eigen::SparseMatrix<double> sum_;     ///< with entries wherever A or a contact has them
  Eigen::SparseMatrix<double> system_;  ///< A, with the pattern of the sum
};

}  // namespace tetwarp
