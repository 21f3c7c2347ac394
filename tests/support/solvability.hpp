/// @file solvability.hpp
/// Contact problems in local form, made from a seed so that their solvability is known.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include <tetwarp/contact.hpp>

#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp::samples {

enum class Solvability {
  solvable,    ///< q = u - W r for impulses r and velocities u that obey the law of friction given
  infeasible,  ///< the normals of all contacts cancel, and their free velocities approach
  jammed       ///< impulses in the friction cones cancel, and the free velocities approach along
               ///< them: with or without a solution
};

/// Tangential impulse of a contact that slides with this velocity: against it (cone), or at the
/// bound of one tangent or of both (pyramid: where it sticks, the velocity becomes 0).
/// @param along  direction of the velocity
inline Eigen::Vector2d sliding_impulse(FrictionLaw law,
                                       double bound,
                                       const Eigen::Vector2d& along,
                                       std::mt19937& random,
                                       Eigen::Ref<Eigen::Vector2d> velocity) {
  if (law == FrictionLaw::cone) return -bound * along;
  Eigen::Vector2d impulse;
  const unsigned slides = 1 + static_cast<unsigned>(random() % 3);  // bit a: along tangent a
  for (int a = 0; a < 2; ++a) {
    impulse(a) = -std::copysign(bound, along(a));
    if ((slides >> a & 1U) != 0) continue;
    impulse(a) *= 0.9 * static_cast<double>(random() % 1000) / 1000;
    velocity(a) = 0;
  }
  return impulse;
}

/// `contacts` contacts of W = scale J J^T with as many or fewer dofs than rows, so that W is rank
/// deficient.
/// @param law  that a solvable problem obeys: a solution with one law is none with the other where
///             contacts slide
inline ContactProblem make_solvability(Solvability kind,
                                       unsigned seed,
                                       Eigen::Index contacts,
                                       double scale = 1,
                                       FrictionLaw law = FrictionLaw::cone) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const Eigen::Index dofs = 3 + static_cast<Eigen::Index>(random() % 4);
  Eigen::MatrixXd jacobian(3 * contacts, dofs);
  for (Eigen::Index i = 0; i < jacobian.size(); ++i) jacobian.data()[i] = normal(random);
  const double friction = kind == Solvability::infeasible && seed % 3 == 0 ? 0 : uniform(random);
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(3 * contacts);
  for (Eigen::Index c = 0; c < contacts; ++c) {
    direction(3 * c) = 0.2 + uniform(random);
    if (kind != Solvability::jammed) continue;
    const double angle = 6.3 * uniform(random), size = friction * uniform(random);
    direction(3 * c + 1) = size * direction(3 * c) * std::cos(angle);
    direction(3 * c + 2) = size * direction(3 * c) * std::sin(angle);
  }
  if (kind != Solvability::solvable) {  // J^T direction = 0 by the last normal row
    const Eigen::Index last = 3 * (contacts - 1);
    const Eigen::VectorXd rest =
        jacobian.transpose() * direction - direction(last) * jacobian.row(last).transpose();
    jacobian.row(last) = -rest.transpose() / direction(last);
  }
  const Eigen::MatrixXd delassus = scale * jacobian * jacobian.transpose();
  Eigen::VectorXd q(3 * contacts);
  for (Eigen::Index i = 0; i < q.size(); ++i) q(i) = normal(random);
  if (kind != Solvability::solvable) {
    const Eigen::Index last = 3 * (contacts - 1);
    q(last) -= (q.dot(direction) + 0.3 * direction.sum()) / direction(last);
  } else {
    Eigen::VectorXd r = Eigen::VectorXd::Zero(q.size()), u = r;
    for (Eigen::Index c = 0; c < contacts; ++c) {
      const double angle = 6.3 * uniform(random), push = uniform(random) / scale;
      const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
      switch (random() % 3) {
        case 0:  // open
          u.segment<3>(3 * c) << uniform(random), along;
          break;
        case 1:  // sticking
          r(3 * c) = push;
          r.segment<2>(3 * c + 1) = 0.9 * friction * push * uniform(random) * along;
          break;
        default:  // sliding
          r(3 * c) = push;
          u.segment<2>(3 * c + 1) = uniform(random) * along;
          r.segment<2>(3 * c + 1) =
              sliding_impulse(law, friction * push, along, random, u.segment<2>(3 * c + 1));
      }
    }
    q = u - delassus * r;
  }
  ContactProblem problem;
  problem.delassus = sparse_of(delassus);
  problem.free_velocity = list_of(q);
  problem.friction.assign(static_cast<std::size_t>(contacts), friction);
  return problem;
}

/// Point masses in a row between two walls that approach by 1 m/s more than there is room for.
/// @param room  m/s by which the walls may approach without contact
inline ContactProblem chain_in_a_vice(std::int64_t bodies, double friction, double room = -1) {
  const std::int64_t contacts = bodies + 1, dofs = 3 * bodies;
  ContactProblem problem;
  problem.system = {dofs, dofs, {0}, {}, {}};
  problem.jacobian = {3 * contacts, dofs, {0}, {}, {}};
  for (std::int64_t d = 0; d < dofs; ++d) {
    problem.system.column.push_back(static_cast<std::int32_t>(d));
    problem.system.value.push_back(1);
    problem.system.row_start.push_back(d + 1);
  }
  for (std::int64_t c = 0; c < contacts; ++c) {
    for (std::int64_t axis = 0; axis < 3; ++axis) {
      for (const std::int64_t body : {c - 1, c}) {
        if (body < 0 || body >= bodies) continue;
        problem.jacobian.column.push_back(static_cast<std::int32_t>(3 * body + axis));
        problem.jacobian.value.push_back(body == c ? 1 : -1);
      }
      problem.jacobian.row_start.push_back(
          static_cast<std::int64_t>(problem.jacobian.column.size()));
    }
  }
  problem.load.assign(static_cast<std::size_t>(dofs), 0.0);
  problem.velocity_offset.assign(static_cast<std::size_t>(3 * contacts), 0.0);
  problem.velocity_offset[3 * static_cast<std::size_t>(contacts / 2)] = room;
  problem.friction.assign(static_cast<std::size_t>(contacts), friction);
  return problem;
}

}  // namespace tetwarp::samples
