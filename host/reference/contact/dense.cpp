/// @file dense.cpp
/// Makes the dense matrices of a problem, and measures its residual.
#include "host/reference/contact/dense.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/reference/contact/bilateral.hpp"

namespace tetwarp::reference {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {
MatrixXd dense_of(const SparseMatrix& matrix) {
  MatrixXd result =
      MatrixXd::Zero(static_cast<Index>(matrix.rows), static_cast<Index>(matrix.columns));
  for (Index row = 0; row < result.rows(); ++row) {
    const auto r = static_cast<std::size_t>(row);
    for (std::int64_t e = matrix.row_start[r]; e < matrix.row_start[r + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      result(row, matrix.column[entry]) += matrix.value[entry];
    }
  }
  return result;
}

VectorXd dense_of(const std::vector<double>& values) {
  return VectorXd::Map(values.data(), static_cast<Index>(values.size()));
}

/// A value per contact; an empty vector means zeros.
VectorXd per_contact(const std::vector<double>& values, Index contacts) {
  return values.empty() ? VectorXd::Zero(contacts) : dense_of(values);
}

void add_adhesion(const ContactProblem& problem, DenseContacts& contacts) {
  const AdhesionState& adhesion = problem.adhesion;
  const Index count = contacts.contact_count();
  contacts.stiffness = VectorXd::Zero(3 * count);
  contacts.offset = VectorXd::Zero(3 * count);
  const VectorXd area = per_contact(adhesion.area, count);
  const VectorXd normal = per_contact(adhesion.stiffness, count);
  const VectorXd beta = per_contact(adhesion.intensity, count);
  const VectorXd tangent = adhesion.tangential_stiffness.empty()
                               ? normal
                               : per_contact(adhesion.tangential_stiffness, count);
  const double dt = adhesion.time_step;
  for (Index c = 0; c < count; ++c) {
    if (beta(c) == 0) continue;
    const double common = dt * dt * area(c) * beta(c) * beta(c);
    contacts.stiffness.segment<3>(3 * c) << common * normal(c), common * tangent(c),
        common * tangent(c);
    if (!problem.is_local() && !adhesion.gap.empty()) {
      // The gap that springs see may differ from dt w_n.
      const auto row = static_cast<std::size_t>(3 * c);
      const double closing = adhesion.gap[row] / dt;
      const double offset = problem.velocity_offset[row];
      const bool is_same = std::abs(closing - offset) <= 1e-9 * std::abs(closing);
      contacts.offset(3 * c) = is_same ? 0 : closing - offset;
    }
    for (Index a = 1; a < 3 && !adhesion.gap.empty(); ++a) {
      contacts.offset(3 * c + a) = adhesion.gap[static_cast<std::size_t>(3 * c + a)] / dt;
    }
  }
}

/// Bound of the friction impulse, max(mu nu_n - chi |spring|, 0): of each tangent for the pyramid,
/// of both together for the cone, in both components.
Vector2d friction_bounds(double friction,
                         const Vector3d& nu,
                         const Vector3d& spring,
                         const ContactOptions& options) {
  Vector2d pull = Vector2d::Zero();
  if (options.rule == AdhesionRule::restrictive) {
    pull = spring.tail<2>().cwiseAbs();
    if (options.law == FrictionLaw::cone) pull.setConstant(pull.norm());
  }
  const double coulomb = friction * std::max(nu(0), 0.0);
  return (Vector2d::Constant(coulomb) - pull).cwiseMax(0.0);
}

/// mu_a / mu along both tangents, mu the larger of both; 1 without friction.
Vector2d ellipse_axes(const DenseContacts& contacts, Index c) {
  const Vector2d mu(contacts.friction(c), contacts.second_friction(c));
  return mu.maxCoeff() > 0 ? Vector2d(mu / mu.maxCoeff()) : Vector2d::Ones();
}

/// The point of a disc, or of a square, nearest to `target`.
Vector2d bounded(const Vector2d& target, const Vector2d& bounds, FrictionLaw law) {
  if (law == FrictionLaw::pyramid) return target.cwiseMax(-bounds).cwiseMin(bounds);
  return target.norm() > bounds(0) ? Vector2d(bounds(0) * target.normalized()) : target;
}

double softest_of(const Eigen::Matrix2d& block) {
  const double apart = block(0, 0) - block(1, 1), mixed = block(0, 1) + block(1, 0);
  return 0.5 * (block.trace() + std::hypot(apart, mixed));
}

/// |e_n|^2 / rho_n + |e_t|^2 / rho_t of one contact.
double residual_energy(const DenseContacts& contacts,
                       Index c,
                       const VectorXd& impulse,
                       const VectorXd& velocity,
                       const ContactOptions& options) {
  const Vector2d axes = ellipse_axes(contacts, c);
  const bool is_ellipse = axes(0) != axes(1);
  const double softest = softest_of(
      axes.asDiagonal() * contacts.delassus.block<2, 2>(3 * c + 1, 3 * c + 1) * axes.asDiagonal());
  const double own = contacts.delassus(3 * c, 3 * c);
  const double rho_n = (own > 0 ? 1 / own : 1) + contacts.stiffness(3 * c);
  // Springs of a contact with an ellipse are measured as bilateral rows, which hold exactly.
  const double rho_t =
      (softest > 0 ? 1 / softest : 1) + (is_ellipse ? 0 : contacts.stiffness(3 * c + 1));

  const Vector3d u = velocity.segment<3>(3 * c);
  const Vector3d spring =
      contacts.stiffness.segment<3>(3 * c).cwiseProduct(u + contacts.offset.segment<3>(3 * c));
  const Vector3d nu = impulse.segment<3>(3 * c) + spring;
  const double mu = std::max(contacts.friction(c), contacts.second_friction(c));
  const Vector2d bounds = friction_bounds(mu, nu, spring, options);
  const Vector2d slip = axes.cwiseProduct(u.tail<2>());
  Vector2d rub = nu.tail<2>();
  for (Index a = 0; a < 2; ++a) rub(a) = axes(a) > 0 ? rub(a) / axes(a) : 0;
  const double normal_error = std::min(nu(0), rho_n * u(0));
  const Vector2d tangent_error = rub - bounded(rub - rho_t * slip, bounds, options.law);
  // Divided before squaring, which would underflow for impulses below 1e-154 N s.
  return normal_error * (normal_error / rho_n) + tangent_error.dot(tangent_error / rho_t);
}

/// The same of one entry of rolling friction.
double rolling_energy(const DenseContacts& contacts,
                      Index entry,
                      const VectorXd& impulse,
                      const VectorXd& velocity) {
  const DenseContacts::Rolling& rolling = contacts.rolling[static_cast<std::size_t>(entry)];
  const Index row = contacts.rolling_row(entry);
  const double push = std::max(impulse(3 * rolling.contact), 0.0);
  const double own = contacts.delassus(row, row);
  const double softest = softest_of(contacts.delassus.block<2, 2>(row + 1, row + 1));
  const double rho_n = own > 0 ? 1 / own : 1, rho_t = softest > 0 ? 1 / softest : 1;
  const double aim = impulse(row) - rho_n * velocity(row);
  const double limit = rolling.torsion * push;
  const double spin_error = impulse(row) - std::clamp(aim, -limit, limit);
  const Vector2d m = impulse.segment<2>(row + 1);
  const Vector2d roll_error =
      m - bounded(m - rho_t * velocity.segment<2>(row + 1),
                  Vector2d::Constant(rolling.rolling * push), FrictionLaw::cone);
  return spin_error * spin_error / rho_n + roll_error.squaredNorm() / rho_t;
}

double residual_norm(const DenseContacts& contacts,
                     const VectorXd& impulse,
                     const VectorXd& velocity,
                     const ContactOptions& options) {
  double energy = 0;
  for (Index c = 0; c < contacts.contact_count(); ++c) {
    energy += residual_energy(contacts, c, impulse, velocity, options);
  }
  for (Index entry = 0; entry < std::ssize(contacts.rolling); ++entry) {
    energy += rolling_energy(contacts, entry, impulse, velocity);
  }
  return std::sqrt(energy);
}
}  // namespace

DenseContacts make_dense(const ContactProblem& problem, double recovery_speed) {
  DenseContacts contacts;
  contacts.friction = dense_of(problem.friction);
  contacts.second_friction =
      problem.second_friction.empty() ? contacts.friction : dense_of(problem.second_friction);
  add_adhesion(problem, contacts);
  if (problem.is_local()) {
    contacts.delassus = dense_of(problem.delassus);
    contacts.free_velocity = dense_of(problem.free_velocity);
    return contacts;
  }
  const Eigen::LLT<MatrixXd> system(dense_of(problem.system));
  if (system.info() != Eigen::Success) {
    throw ContactProblemError("system",
                              ": not positive definite; give every body mass and inertia");
  }
  const RollingFriction& rolling = problem.rolling;
  const Index rows = 3 * (contacts.contact_count() + std::ssize(rolling.contact));
  MatrixXd jacobian(rows, system.rows());
  VectorXd offset = VectorXd::Zero(rows);
  if (contacts.contact_count() > 0) {
    const Index contact_rows = 3 * contacts.contact_count();
    jacobian.topRows(contact_rows) = dense_of(problem.jacobian);
    offset.head(contact_rows) = dense_of(problem.velocity_offset);
  }
  for (Index c = 0; c < contacts.contact_count(); ++c) {
    offset(3 * c) = std::max(offset(3 * c), -recovery_speed);
  }
  if (!rolling.empty()) jacobian.bottomRows(3 * rolling.count()) = dense_of(rolling.jacobian);
  for (std::size_t k = 0; k < rolling.contact.size(); ++k) {
    contacts.rolling.push_back({Index{rolling.contact[k]}, rolling.rolling[k], rolling.torsion[k]});
  }
  contacts.free_body_velocity = system.solve(dense_of(problem.load));
  contacts.body_change =
      rows > 0 ? MatrixXd(system.solve(jacobian.transpose())) : MatrixXd(system.rows(), 0);
  contacts.delassus = jacobian * contacts.body_change;
  contacts.free_velocity = jacobian * contacts.free_body_velocity + offset;
  if (!problem.bilateral.empty()) {
    eliminate_bilateral(problem, system, jacobian, offset, contacts);
  }
  return contacts;
}

double eta_of(const DenseContacts& contacts,
              const VectorXd& impulse,
              const ContactOptions& options) {
  const VectorXd none = VectorXd::Zero(impulse.size());
  const double work = impulse.dot(contacts.delassus * impulse);
  const VectorXd sizes = impulse.cwiseAbs();
  const double rounding = std::ldexp(sizes.dot(contacts.delassus.cwiseAbs() * sizes), -49);
  const double scale = residual_norm(contacts, none, contacts.free_velocity, options) +
                       (work > rounding ? std::sqrt(work - rounding) : 0.0);
  const VectorXd velocity = contacts.velocity(impulse);
  const double error = residual_norm(contacts, impulse, velocity, options);
  const bool is_finite =
      impulse.allFinite() && velocity.allFinite() && std::isfinite(error) && std::isfinite(scale);
  if (!is_finite) return std::numeric_limits<double>::infinity();
  return error == 0 ? 0 : error / scale;
}

}  // namespace tetwarp::reference
