/// @file enumerate.cpp
/// All solutions of a small problem, by trying all combinations of states of its contacts.
#include "host/reference/contact/enumerate.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "host/reference/contact/dense.hpp"
#include "host/reference/linear/least_norm.hpp"

namespace tetwarp::reference {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {
/// State of one tangent of a closed contact.
struct TangentMode {
  bool sticks = false;
  int slide = 0;   ///< sign of u if it slides; 0: no friction
  int spring = 0;  ///< sign of u + o where the spring reduces the friction (rule restrictive)
};

constexpr std::array free_tangent{TangentMode{}};
constexpr std::array coulomb_tangent{TangentMode{true, 0, 0}, TangentMode{false, 1, 0},
                                     TangentMode{false, -1, 0}};
constexpr std::array restrictive_tangent{TangentMode{true, 0, 0},   TangentMode{},
                                         TangentMode{false, 1, 1},  TangentMode{false, 1, -1},
                                         TangentMode{false, -1, 1}, TangentMode{false, -1, -1}};

std::span<const TangentMode> tangent_modes(const DenseContacts& contacts,
                                           Index c,
                                           const ContactOptions& options) {
  if (contacts.friction(c) == 0 && contacts.second_friction(c) == 0) return free_tangent;
  const bool shares =
      options.rule == AdhesionRule::restrictive && contacts.stiffness(3 * c + 1) > 0;
  if (shares) return restrictive_tangent;
  return coulomb_tangent;
}

/// Number of states of a contact: open, or closed with a mode for each tangent.
Index contact_modes(std::span<const TangentMode> tangent) {
  return 1 + static_cast<Index>(tangent.size() * tangent.size());
}

/// The laws of all contacts in given modes, as M nu = y. With the springs eliminated, velocities
/// are u = C nu + f, C = (I + B K)^-1 B, f = (I + B K)^-1 (q - B K o).
class ModeSystem {
 public:
  explicit ModeSystem(const DenseContacts& contacts)
      : contacts_(contacts),
        impulse_from_(MatrixXd::Identity(contacts.stiffness.size(), contacts.stiffness.size()) +
                      contacts.stiffness.asDiagonal() * contacts.delassus) {
    const Index rows = contacts.free_velocity.size();
    const Eigen::PartialPivLU<MatrixXd> with_springs(
        MatrixXd::Identity(rows, rows) + contacts.delassus * contacts.stiffness.asDiagonal());
    compliance_ = with_springs.solve(contacts.delassus);
    free_ =
        with_springs.solve(contacts.free_velocity -
                           contacts.delassus * contacts.stiffness.cwiseProduct(contacts.offset));
    matrix_.resize(rows, rows);
    right_.resize(rows);
  }

  void set_open(Index c) {
    for (Index row = 3 * c; row < 3 * c + 3; ++row) set_impulse(row, 0);
  }

  void set_closed(Index c, const TangentMode& first, const TangentMode& second) {
    set_velocity(3 * c);
    set_tangent(c, 3 * c + 1, first);
    set_tangent(c, 3 * c + 2, second);
  }

  /// r = nu - K (u + o), computed without cancellation from (I + K B) r = nu - K (q + o). Where nu
  /// is not unique, the one of least norm.
  VectorXd impulse() const {
    const VectorXd nu = least_norm_solution(matrix_, right_);
    return impulse_from_.solve(
        nu - contacts_.stiffness.cwiseProduct(contacts_.free_velocity + contacts_.offset));
  }

 private:
  /// u = 0 in this row.
  void set_velocity(Index row) {
    matrix_.row(row) = compliance_.row(row);
    right_(row) = -free_(row);
  }

  void set_impulse(Index row, double value) {
    matrix_.row(row).setZero();
    matrix_(row, row) = 1;
    right_(row) = value;
  }

  /// nu = -slide (mu nu_n - spring kappa (u + o)) where it slides.
  void set_tangent(Index c, Index row, const TangentMode& mode) {
    if (mode.sticks) return set_velocity(row);
    set_impulse(row, 0);
    const Eigen::VectorXd& mu = row == 3 * c + 1 ? contacts_.friction : contacts_.second_friction;
    matrix_(row, 3 * c) += mode.slide * mu(c);
    const double kappa = mode.slide * mode.spring * contacts_.stiffness(row);
    matrix_.row(row) -= kappa * compliance_.row(row);
    right_(row) += kappa * (free_(row) + contacts_.offset(row));
  }

  const DenseContacts& contacts_;
  Eigen::PartialPivLU<MatrixXd> impulse_from_;
  MatrixXd compliance_;
  VectorXd free_;
  MatrixXd matrix_;
  VectorXd right_;
};
}  // namespace

double mode_count(const DenseContacts& contacts, const ContactOptions& options) {
  const bool has_friction =
      (contacts.friction.array() > 0).any() || (contacts.second_friction.array() > 0).any();
  if ((options.law == FrictionLaw::cone && has_friction) || !contacts.rolling.empty()) {
    return std::numeric_limits<double>::infinity();
  }
  double count = 1;
  for (Index c = 0; c < contacts.contact_count(); ++c) {
    count *= static_cast<double>(contact_modes(tangent_modes(contacts, c, options)));
  }
  return count;
}

std::vector<VectorXd> enumerate_impulses(const DenseContacts& contacts,
                                         const ContactOptions& options) {
  constexpr double satisfied = 1e-11;  // rounding errors are smaller, those of a wrong mode larger
  const auto systems = static_cast<std::int64_t>(mode_count(contacts, options));
  ModeSystem system(contacts);
  std::vector<VectorXd> solutions;
  for (std::int64_t number = 0; number < systems; ++number) {
    std::int64_t rest = number;
    for (Index c = 0; c < contacts.contact_count(); ++c) {
      const auto tangent = tangent_modes(contacts, c, options);
      const Index mode = rest % contact_modes(tangent);
      rest /= contact_modes(tangent);
      if (mode == 0) {
        system.set_open(c);
      } else {
        const auto pair = static_cast<std::size_t>(mode - 1);
        system.set_closed(c, tangent[pair / tangent.size()], tangent[pair % tangent.size()]);
      }
    }
    const VectorXd impulse = system.impulse();
    if (!(eta_of(contacts, impulse, options) <= satisfied)) continue;
    const VectorXd velocity = contacts.velocity(impulse);
    const bool is_known =
        std::any_of(solutions.begin(), solutions.end(), [&](const VectorXd& known) {
          return (contacts.velocity(known) - velocity).norm() <=
                 1e-6 * (velocity.norm() + contacts.free_velocity.norm());
        });
    if (!is_known) solutions.push_back(impulse);
  }
  return solutions;
}

}  // namespace tetwarp::reference
