/// @file gauss_seidel.cpp
/// Sweeps by the problem of one contact, until the residual is small enough.
#include "host/reference/contact/gauss_seidel.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "host/reference/contact/local.hpp"

namespace tetwarp::reference {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {
constexpr double goal = 1e-12;
constexpr std::int64_t sweeps_per_residual = 10;

/// One pass over all contacts in their order.
/// @param impulse   in and out
/// @param velocity  in and out: that of the impulses
/// @return whether any impulse changed
bool sweep(const DenseContacts& contacts,
           const ContactOptions& options,
           VectorXd& impulse,
           VectorXd& velocity) {
  bool has_changed = false;
  for (Index c = 0; c < contacts.contact_count(); ++c) {
    const LocalContact local{
        contacts.delassus.block<3, 3>(3 * c, 3 * c), contacts.stiffness.segment<3>(3 * c),
        contacts.offset.segment<3>(3 * c), contacts.friction(c), contacts.second_friction(c)};
    const Vector3d before = impulse.segment<3>(3 * c);
    const Vector3d u = velocity.segment<3>(3 * c);
    const Vector3d after = options.law == FrictionLaw::cone
                               ? solve_cone(local, u - local.delassus * before, options)
                               : update_pyramid(local, before, u, options);
    if (after == before) continue;
    velocity += contacts.delassus.middleCols<3>(3 * c) * (after - before);
    impulse.segment<3>(3 * c) = after;
    has_changed = true;
  }
  for (Index entry = 0; entry < std::ssize(contacts.rolling); ++entry) {
    const DenseContacts::Rolling& rolling = contacts.rolling[static_cast<std::size_t>(entry)];
    const Index row = contacts.rolling_row(entry);
    const double push = std::max(impulse(3 * rolling.contact), 0.0);
    const Vector3d before = impulse.segment<3>(row);
    const Vector3d after =
        update_rolling(contacts.delassus.block<3, 3>(row, row), before, velocity.segment<3>(row),
                       rolling.torsion * push, rolling.rolling * push);
    if (after == before) continue;
    velocity += contacts.delassus.middleCols<3>(row) * (after - before);
    impulse.segment<3>(row) = after;
    has_changed = true;
  }
  return has_changed;
}
}  // namespace

SweptImpulses gauss_seidel(const DenseContacts& contacts,
                           const ContactOptions& options,
                           VectorXd start) {
  SweptImpulses swept;
  VectorXd impulse = std::move(start);
  swept.impulse = impulse;
  double best = eta_of(contacts, impulse, options);
  swept.residual_history.push_back(best);
  bool has_changed = true;
  while (has_changed && best > goal && swept.sweeps < options.max_sweeps) {
    const std::int64_t sweeps = std::min(sweeps_per_residual, options.max_sweeps - swept.sweeps);
    // Velocities are updated with the impulses for a few sweeps, then recomputed, so that rounding
    // errors do not accumulate.
    VectorXd velocity = contacts.velocity(impulse);
    for (std::int64_t s = 0; s < sweeps; ++s) {
      has_changed = sweep(contacts, options, impulse, velocity);
    }
    swept.sweeps += sweeps;
    const double eta = eta_of(contacts, impulse, options);
    swept.residual_history.push_back(eta);
    if (eta >= best) continue;
    best = eta;
    swept.impulse = impulse;
  }
  return swept;
}

}  // namespace tetwarp::reference
