/// @file matrix.hpp
/// Sparse rows as Eigen wants them, and the blocks of dofs that belong together.
#pragma once
#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// True when the columns of every row rise strictly: sorted, nothing repeated.
bool has_sorted_rows(const SparseMatrix& matrix);

/// The same matrix with sorted rows, repeated entries added up in the order they stood.
SparseMatrix make_sorted(const SparseMatrix& matrix);

/// The same matrix for Eigen, by columns.
Eigen::SparseMatrix<double> make_eigen(const SparseMatrix& matrix);

/// First dof of each block of the system, then the dof count: `block_start` where the problem has
/// one; else the shortest ranges of dofs that the system does not couple, those of over 12 dofs cut
/// into nodes of 3.
/// @pre problem.system has valid indices
std::vector<std::int32_t> blocks_of(const ContactProblem& problem);

}  // namespace tetwarp
