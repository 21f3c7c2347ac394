/// @file contact_assembly.cpp
/// Finds the places of all sums once, then adds in these.
#include "host/contact/newton/contact_assembly.hpp"

#include <algorithm>
#include <cstddef>

namespace tetwarp {

using Eigen::Index;
using Eigen::Matrix3d;
using Matrix = Eigen::SparseMatrix<double>;

namespace {
/// Columns in which any of the three rows of each contact has an entry, in increasing order.
std::vector<std::vector<Index>> dofs_of_contacts(const Matrix& jacobian) {
  std::vector<std::vector<Index>> dofs(static_cast<std::size_t>(jacobian.rows() / 3));
  for (Index column = 0; column < jacobian.cols(); ++column) {
    for (Matrix::InnerIterator entry(jacobian, column); entry; ++entry) {
      std::vector<Index>& own = dofs[static_cast<std::size_t>(entry.row() / 3)];
      if (own.empty() || own.back() != column) own.push_back(column);
    }
  }
  return dofs;
}

/// The place of an entry among the values of a compressed matrix.
std::int32_t place_of(const Matrix& matrix, Index row, Index column) {
  const auto* const first = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column];
  const auto* const last = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column + 1];
  return static_cast<std::int32_t>(std::lower_bound(first, last, row) - matrix.innerIndexPtr());
}
}  // namespace

ContactAssembly::ContactAssembly(const Matrix& system, const Matrix& jacobian) {
  // Entries of one contact in different rows of J couple its dofs, too.
  Matrix touched(jacobian.rows() / 3, jacobian.cols());
  std::vector<Eigen::Triplet<double>> entries;
  const std::vector<std::vector<Index>> dofs = dofs_of_contacts(jacobian);
  std::size_t pairs = 0;
  for (std::size_t c = 0; c < dofs.size(); ++c) {
    pairs += dofs[c].size() * dofs[c].size();
    for (const Index dof : dofs[c]) {
      entries.emplace_back(static_cast<int>(c), static_cast<int>(dof), 1.0);
    }
  }
  touched.setFromTriplets(entries.begin(), entries.end());
  const Matrix pattern = Matrix(touched.transpose()) * touched;
  system_ = system + 0.0 * pattern;
  system_.makeCompressed();
  sum_ = system_;
  jacobian_.reserve(dofs.size());
  place_.reserve(pairs);
  const Eigen::SparseMatrix<double, Eigen::RowMajor> rows = jacobian;
  for (std::size_t c = 0; c < dofs.size(); ++c) {
    Columns& own = jacobian_.emplace_back(Columns::Zero(3, static_cast<Index>(dofs[c].size())));
    for (int row = 0; row < 3; ++row) {
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(
               rows, 3 * static_cast<Index>(c) + row);
           entry; ++entry) {
        own(row, std::lower_bound(dofs[c].begin(), dofs[c].end(), entry.col()) - dofs[c].begin()) =
            entry.value();
      }
    }
    for (const Index column : dofs[c]) {
      for (const Index row : dofs[c]) place_.push_back(place_of(sum_, row, column));
    }
  }
}

const Matrix& ContactAssembly::sum(const std::vector<Matrix3d>& response) {
  std::copy_n(system_.valuePtr(), system_.nonZeros(), sum_.valuePtr());
  double* const values = sum_.valuePtr();
  const std::int32_t* place = place_.data();
  for (std::size_t c = 0; c < jacobian_.size(); ++c) {
    const Columns& own = jacobian_[c];
    for (Index column = 0; column < own.cols(); ++column) {
      const Eigen::Vector3d pushed = response[c] * own.col(column);
      for (Index row = 0; row < own.cols(); ++row) values[*place++] += own.col(row).dot(pushed);
    }
  }
  return sum_;
}

}  // namespace tetwarp
