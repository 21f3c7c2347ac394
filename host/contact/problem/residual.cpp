/// @file residual.cpp
/// residual_of(): residuals of given impulses and velocities.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <tetwarp/contact.hpp>
#include <utility>
#include <vector>

#include "host/contact/problem/delassus.hpp"
#include "host/contact/problem/imbalance.hpp"
#include "host/contact/problem/measure.hpp"
#include "host/contact/problem/residual.hpp"
#include "host/contact/problem/row_blocks.hpp"
#include "host/contact/problem/spring_offset.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {
struct Eta {
  double total = 0;
  double largest = 0;
  std::int64_t largest_contact = -1;
  std::vector<double> shares;  ///< of each contact
};

/// eta = sqrt(energy(r, u)) / (sqrt(energy(0, u - B r)) + sqrt(r . B r)): relative to the residual
/// without impulses. r . B r counts as far as it is resolved; see resolved_energy().
/// @param velocity_change  B r
/// @param magnitude        |r| . |B| |r|
Eta eta_of(std::vector<MeasuredContact> contacts,
           const VectorXd& impulse,
           const VectorXd& velocity,
           const VectorXd& velocity_change,
           double magnitude,
           const ContactOptions& options) {
  double energy = 0;
  double free_energy = 0;
  double largest = 0;
  Eta eta;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const auto row = 3 * static_cast<Index>(c);
    const Vector3d u = velocity.segment<3>(row);
    const double share =
        natural_energy(contacts[c], impulse.segment<3>(row), u, options.law, options.rule);
    energy += share;
    eta.shares.push_back(share);
    contacts[c].push = 0;  // of zero impulses
    free_energy += natural_energy(contacts[c], Vector3d::Zero(),
                                  u - velocity_change.segment<3>(row), options.law, options.rule);
    if (share <= largest) continue;  // a share that is not a number counts as the largest
    largest = share;
    eta.largest_contact = static_cast<std::int64_t>(c);
  }
  const double scale =
      std::sqrt(free_energy) + std::sqrt(resolved_energy(impulse.dot(velocity_change), magnitude));
  const bool is_finite = impulse.allFinite() && velocity.allFinite();
  eta.total = relative_error(is_finite ? std::sqrt(energy) : NAN, scale);
  eta.largest = relative_error(std::sqrt(largest), scale);
  for (double& share : eta.shares) share = relative_error(std::sqrt(share), scale);
  return eta;
}

double fclib_of(const std::vector<MeasuredContact>& contacts,
                const VectorXd& impulse,
                const VectorXd& velocity,
                double scale,
                const ContactOptions& options) {
  double sum = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const auto row = 3 * static_cast<Index>(c);
    sum += fclib_square(contacts[c], impulse.segment<3>(row), velocity.segment<3>(row), options.law,
                        options.rule);
  }
  const bool is_finite = impulse.allFinite() && velocity.allFinite();
  return relative_error(is_finite ? std::sqrt(sum) : NAN, scale);
}

VectorXd make_vector(std::span<const double> values, Index expected, const char* name) {
  const auto size = static_cast<Index>(values.size());
  if (size != expected) {
    throw std::invalid_argument(std::string(name) + ": " + std::to_string(size) +
                                " entries, expected " + std::to_string(expected));
  }
  return Eigen::Map<const VectorXd>(values.data(), size);
}
}  // namespace

BlockResiduals residuals_of_blocks(const ContactProblem& problem,
                                   std::span<const double> impulse,
                                   std::span<const double> body_velocity,
                                   const ContactOptions& options) {
  const std::vector<double> preloads = spring_preloads(problem);
  if (!preloads.empty() && impulse.size() == 3 * preloads.size()) {
    std::vector<double> shifted(impulse.begin(), impulse.end());
    add_preloads(preloads, 1, shifted);
    return residuals_of_blocks(with_preloads(problem, preloads), shifted, body_velocity, options);
  }
  const Delassus delassus(problem, options.recovery_speed);
  std::vector<MeasuredContact> contacts = measured_contacts(problem);
  const std::vector<Eigen::Matrix3d> blocks = delassus.diagonal_blocks();
  for (std::size_t c = 0; c < contacts.size(); ++c) contacts[c].diagonal_block = blocks[c];

  const VectorXd r =
      make_vector(impulse, 3 * static_cast<Index>(problem.contact_count()), "impulse");
  set_pushes(contacts, r);
  const VectorXd change = delassus.velocity_change(r);
  const VectorXd implied = change + delassus.free_velocity();
  VectorXd u = implied;
  BlockResiduals result;
  ContactResidual& residual = result.residual;
  if (!problem.is_local()) {
    const VectorXd v =
        body_velocity.empty()
            ? delassus.body_velocity(r)
            : make_vector(body_velocity, static_cast<Index>(problem.dof_count()), "body_velocity");
    if (!body_velocity.empty()) u = delassus.contact_velocity(v);
    residual.balance = imbalance(problem, impulse, {v.data(), static_cast<std::size_t>(v.size())});
  }
  const double magnitude = delassus.magnitude(r);
  Eta eta = eta_of(contacts, r, u, change, magnitude, options);
  if (!body_velocity.empty()) {
    // The given velocities may differ from those of the impulses; the larger error counts.
    const Eta caused = eta_of(contacts, r, implied, change, magnitude, options);
    if (caused.total > eta.total) eta = caused;
  }
  residual.eta = eta.total;
  residual.largest = eta.largest;
  residual.largest_contact = eta.largest_contact;
  residual.fclib = fclib_of(contacts, r, u, delassus.free_velocity().norm(), options);
  for (Index row = 0; row < u.size(); row += 3) {
    if (!is_contact_block(problem, static_cast<std::size_t>(row / 3))) continue;
    if (!(-u(row) <= residual.penetration)) residual.penetration = -u(row);
  }
  result.share = std::move(eta.shares);
  result.contacts = std::move(contacts);
  result.impulse = r;
  result.velocity = u;
  return result;
}

ContactResidual residual_of(const ContactProblem& problem,
                            std::span<const double> impulse,
                            std::span<const double> body_velocity,
                            const ContactOptions& options) {
  check_problem(problem);
  if (!problem.bilateral.empty() || !problem.rolling.empty()) {
    throw std::invalid_argument(
        "impulse: the problem has bilateral rows or rolling friction; give the whole solution");
  }
  if (!needs_blocks(problem))
    return residuals_of_blocks(problem, impulse, body_velocity, options).residual;
  ContactSolution solution;
  solution.impulse.assign(impulse.begin(), impulse.end());
  solution.body_velocity.assign(body_velocity.begin(), body_velocity.end());
  return residual_of(problem, solution, options);
}

ContactResidual residual_of(const ContactProblem& problem,
                            const ContactSolution& solution,
                            const ContactOptions& options) {
  return residuals_of(problem, solution, options).residual;
}

BlockResiduals residuals_of(const ContactProblem& problem,
                            const ContactSolution& solution,
                            const ContactOptions& options) {
  check_problem(problem);
  if (!needs_blocks(problem)) {
    return residuals_of_blocks(problem, solution.impulse, solution.body_velocity, options);
  }
  const std::vector<double> preloads = spring_preloads(problem);
  if (!preloads.empty() && solution.impulse.size() == 3 * preloads.size()) {
    ContactSolution shifted = solution;
    add_preloads(preloads, 1, shifted.impulse);
    return residuals_of(with_preloads(problem, preloads), shifted, options);
  }
  const BlockProblem blocks(problem, options);
  const std::vector<double> impulse = blocks.impulse_of(solution);
  std::vector<double> body_velocity;
  if (!solution.body_velocity.empty()) body_velocity = blocks.body_velocity_of(solution, impulse);
  return residuals_of_blocks(blocks.problem(), impulse, body_velocity, options);
}

}  // namespace tetwarp
