/// @file matrix.hpp
/// Sparse matrices of contact problems: order of their entries, forms of storage, blocks of dofs.
#pragma once
#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// True when the columns of every row rise strictly: sorted, nothing repeated.
bool has_sorted_rows(const SparseMatrix& matrix);

/// The same matrix with sorted rows; repeated entries are added in the order they are stored in.
SparseMatrix make_sorted(const SparseMatrix& matrix);

/// Whether a matrix is stored as dense 3x3 blocks, which CondensedProblem does with its Delassus
/// matrix: row_start and column are empty, and value is [rows / 3][columns / 3][3][3].
/// check_problem() rejects such a matrix in a problem of the caller.
inline bool has_dense_blocks(const SparseMatrix& matrix) {
  return matrix.rows > 0 && matrix.row_start.empty();
}

/// The same matrix by rows, with all its entries.
/// @pre has_dense_blocks(blocks)
SparseMatrix make_rows(const SparseMatrix& blocks);

/// The same matrix for Eigen, by columns.
Eigen::SparseMatrix<double> make_eigen(const SparseMatrix& matrix);

/// First dof of each block of the system, then the dof count: `block_start` of the problem if it is
/// given; else the shortest ranges of dofs that the system does not couple, those of more than 12
/// dofs cut into nodes of 3.
/// @pre problem.system has valid indices
std::vector<std::int32_t> blocks_of(const ContactProblem& problem);

}  // namespace tetwarp
