/// @file certificate.cpp
/// Searches such impulses by the interior-point method of AssociatedContact, and bounds their
/// work.
#include "host/contact/solve/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host/contact/newton/associated.hpp"
#include "host/contact/newton/newton_system.hpp"
#include "host/contact/problem/delassus.hpp"
#include "host/contact/problem/measure.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {
/// The contacts without springs; with DirectionCone::normals also without friction.
std::vector<MeasuredContact> bare_contacts(const ContactProblem& problem,
                                           const Delassus& delassus,
                                           DirectionCone cone) {
  std::vector<MeasuredContact> contacts = measured_contacts(problem);
  const std::vector<Eigen::Matrix3d> blocks = delassus.diagonal_blocks();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    contacts[c].diagonal_block = blocks[c];
    contacts[c].stiffness.setZero();
    contacts[c].offset.setZero();
    if (cone == DirectionCone::normals) contacts[c].friction = 0;
  }
  return contacts;
}

/// A point of the cone of a contact close to d.
Vector3d moved_into_cone(const Vector3d& d, double friction, FrictionLaw law) {
  Vector3d result(std::max(d(0), 0.0), 0, 0);
  const double radius = friction * result(0);
  if (law == FrictionLaw::cone) {
    const double length = d.tail<2>().norm();
    result.tail<2>() = d.tail<2>() * (length > radius ? radius / length : 1.0);
  } else {
    result.tail<2>() = d.tail<2>().cwiseMax(-radius).cwiseMin(radius);
  }
  return result;
}
}  // namespace

std::optional<ImpulseDirection> find_direction(const ContactProblem& problem,
                                               const ContactOptions& options,
                                               DirectionCone cone,
                                               SolveBudget* budget) {
  constexpr double far = 1e6;
  if (budget != nullptr) {
    if (budget->is_over()) return {};
    if (!budget->allows_memory(newton_cost(problem, budget->memory_limit()).bytes)) return {};
    budget->start_newton();
  }
  const Delassus delassus(problem, options.recovery_speed);
  const std::vector<MeasuredContact> contacts = bare_contacts(problem, delassus, cone);
  const VectorXd& q = delassus.free_velocity();
  double required = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const double approach = std::min(q(3 * static_cast<Index>(c)), 0.0);
    required += approach * approach / contacts[c].diagonal_block(0, 0);
  }
  if (!(required > 0)) return {};  // zero impulses satisfy all contacts
  NewtonSystem system(problem, delassus);
  AssociatedContact solver(contacts, options.law, delassus, system, budget);
  solver.solve(VectorXd::Zero(static_cast<Index>(contacts.size())));
  VectorXd d = solver.last_impulse();
  const double largest = d.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !d.allFinite()) return {};
  d /= largest;
  double push = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Index row = 3 * static_cast<Index>(c);
    d.segment<3>(row) = moved_into_cone(d.segment<3>(row), contacts[c].friction, options.law);
    push += d(row);
  }
  const double gain = -q.dot(d);
  const double work = std::max(d.dot(delassus.velocity_change(d)), 0x1p-53 * delassus.magnitude(d));
  const double distance = gain / std::sqrt(work * required);
  if (!(gain > 0) || !(distance > far)) return {};
  return ImpulseDirection{{d.begin(), d.end()}, gain / push, distance};
}

}  // namespace tetwarp
