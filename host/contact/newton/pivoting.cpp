/// @file pivoting.cpp
/// The linear complementarity problem of the friction pyramid, and Lemke's method on it.
#include "host/contact/newton/pivoting.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <random>

#include "host/contact/problem/delassus.hpp"
#include "host/contact/problem/measure.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {
constexpr Index rows_per_contact = 7;
/// Relative size below which an entry of a pivot column is rounding.
constexpr double rounding = 1e-11;
/// Relative error of the conditions above which the end of a path is no solution but rounding.
constexpr double loss = 1e-6;

/// The tableau w = M z + q + d z0 of Lemke's method: columns of w, of z, of z0, and the values.
class Tableau {
 public:
  Tableau(const MatrixXd& matrix, const VectorXd& right_side, const VectorXd& cover)
      : size_(matrix.rows()),
        table_(size_, 2 * size_ + 2),
        basis_(static_cast<std::size_t>(size_)) {
    table_.leftCols(size_).setIdentity();
    table_.middleCols(size_, size_) = -matrix;
    table_.col(2 * size_) = -cover;
    table_.col(2 * size_ + 1) = right_side;
    std::iota(basis_.begin(), basis_.end(), Index{0});
  }

  /// @return  z, or none where the path ends in a ray or is too long
  std::optional<VectorXd> follow() {
    Index row = 0;
    // z0 enters at the row that it must raise most.
    const VectorXd need = table_.col(2 * size_ + 1).cwiseQuotient(table_.col(2 * size_));
    if (!(need.maxCoeff(&row) > 0)) return VectorXd(VectorXd::Zero(size_));
    Index entering = 2 * size_;
    for (Index step = 0; step < 20 * size_; ++step) {
      const Index leaving = basis_[static_cast<std::size_t>(row)];
      exchange(row, entering);
      if (leaving == 2 * size_) return solution();
      entering = leaving < size_ ? leaving + size_ : leaving - size_;
      row = leaving_row(entering);
      if (row < 0) return {};
    }
    return {};
  }

 private:
  void exchange(Index row, Index entering) {
    basis_[static_cast<std::size_t>(row)] = entering;
    table_.row(row) /= table_(row, entering);
    VectorXd factor = table_.col(entering);
    factor(row) = 0;
    const Eigen::RowVectorXd pivot = table_.row(row);
    table_.noalias() -= factor * pivot;
  }

  /// The row of the basic variable that becomes 0 first: z0 where it is among them up to rounding,
  /// else the one with the largest pivot. -1: none becomes 0.
  Index leaving_row(Index entering) const {
    const auto column = table_.col(entering);
    const auto value = table_.col(2 * size_ + 1);
    const double least = rounding * column.cwiseAbs().maxCoeff();
    double limit = std::numeric_limits<double>::infinity();
    for (Index row = 0; row < size_; ++row) {
      if (column(row) > least) limit = std::min(limit, std::max(value(row), 0.0) / column(row));
    }
    const double slack = rounding * value.cwiseAbs().maxCoeff();
    Index best = -1;
    for (Index row = 0; row < size_; ++row) {
      if (!(column(row) > least) || value(row) - limit * column(row) > slack) continue;
      if (basis_[static_cast<std::size_t>(row)] == 2 * size_) return row;
      if (best < 0 || column(row) > column(best)) best = row;
    }
    return best;
  }

  VectorXd solution() const {
    VectorXd z = VectorXd::Zero(size_);
    for (Index row = 0; row < size_; ++row) {
      const Index variable = basis_[static_cast<std::size_t>(row)];
      if (variable >= size_ && variable < 2 * size_) {
        z(variable - size_) = std::max(table_(row, 2 * size_ + 1), 0.0);
      }
    }
    return z;
  }

  Index size_;
  MatrixXd table_;
  std::vector<Index> basis_;  ///< variable of each row: w, z, z0
};
}  // namespace

bool FrictionPivoting::applies(const ContactProblem& problem, const ContactOptions& options) {
  return options.law == FrictionLaw::pyramid && problem.contact_count() <= max_contacts &&
         problem.expert.row_blocks.empty() &&
         (options.rule == AdhesionRule::parallel || problem.adhesion.empty());
}

FrictionPivoting::FrictionPivoting(const ContactProblem& problem, const ContactOptions& options) {
  const Delassus delassus(problem, options.recovery_speed);
  const std::vector<MeasuredContact> contacts = measured_contacts(problem);
  const Index size = 3 * static_cast<Index>(contacts.size());
  MatrixXd product(size, size);
  for (Index i = 0; i < size; ++i) {
    product.col(i) = delassus.velocity_change(VectorXd::Unit(size, i));
  }
  stiffness_.resize(size);
  offset_.resize(size);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    stiffness_.segment<3>(3 * static_cast<Index>(c)) = contacts[c].stiffness;
    offset_.segment<3>(3 * static_cast<Index>(c)) = contacts[c].offset;
  }
  // u = B (nu - K (u + o)) + q
  const Eigen::PartialPivLU<MatrixXd> springs(MatrixXd::Identity(size, size) +
                                              product * stiffness_.asDiagonal());
  velocity_ = springs.solve(product);
  free_velocity_ =
      springs.solve(delassus.free_velocity() - product * stiffness_.cwiseProduct(offset_));

  // nu = spread z; the velocities in the conditions are spread^T u.
  const Index rows = rows_per_contact * static_cast<Index>(contacts.size());
  MatrixXd spread = MatrixXd::Zero(size, rows);
  matrix_ = MatrixXd::Zero(rows, rows);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Index first = rows_per_contact * static_cast<Index>(c), row = 3 * static_cast<Index>(c);
    spread(row, first) = 1;
    for (Index axis = 0; axis < 2; ++axis) {
      const Index slip = first + 5 + axis;
      matrix_(slip, first) = contacts[c].friction;
      for (const Index side : {0, 1}) {
        const Index push = first + 1 + 2 * axis + side;
        spread(row + 1 + axis, push) = side == 0 ? 1 : -1;
        matrix_(push, slip) = 1;
        matrix_(slip, push) = -1;
      }
    }
  }
  matrix_ += spread.transpose() * velocity_ * spread;
  right_side_ = spread.transpose() * free_velocity_;
}

std::optional<std::vector<double>> FrictionPivoting::solve(std::uint32_t start) const {
  std::mt19937 random(start);
  VectorXd cover(right_side_.size());
  const double scale = right_side_.cwiseAbs().maxCoeff();
  // Entries of about the same size lead to few different solutions, much smaller ones to rounding.
  const double decades = start % 2 == 0 ? 2 : 6;
  for (double& entry : cover) {
    entry = scale * std::pow(10.0, -decades * static_cast<double>(random()) / 0x1p32);
  }
  std::optional<VectorXd> z = Tableau(matrix_, right_side_, cover).follow();
  if (!z || !z->allFinite()) return {};
  const VectorXd rest = matrix_ * *z + right_side_;
  const double largest = z->maxCoeff();
  for (Index i = 0; i < rest.size(); ++i) {
    const bool is_active = (*z)(i) > loss * largest;
    if (rest(i) < -loss * scale || (is_active && rest(i) > loss * scale)) return {};
    if (rest(i) > loss * scale) (*z)(i) = 0;
  }
  VectorXd nu(stiffness_.size());
  for (Index c = 0; 3 * c < nu.size(); ++c) {
    const auto own = z->segment<5>(rows_per_contact * c);
    const double bound = matrix_(rows_per_contact * c + 5, rows_per_contact * c) * own(0);
    nu.segment<3>(3 * c) << own(0), std::clamp(own(1) - own(2), -bound, bound),
        std::clamp(own(3) - own(4), -bound, bound);
  }
  const VectorXd velocity = velocity_ * nu + free_velocity_;
  const VectorXd impulse = nu - stiffness_.cwiseProduct(velocity + offset_);
  return std::vector<double>(impulse.begin(), impulse.end());
}

}  // namespace tetwarp
