/// @file gauss_seidel.hpp
/// Projected Gauss-Seidel over the contacts in their order. Part of back end `reference`.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/reference/contact/dense.hpp"

namespace tetwarp::reference {

struct SweptImpulses {
  Eigen::VectorXd impulse;  ///< those with the least eta
  std::int64_t sweeps = 0;
  std::vector<double> residual_history;  ///< eta at the start and after every ten sweeps
};

/// Sweeps from `start` until eta is at most 1e-12, no impulse changes any more, or
/// options.max_sweeps have been made.
SweptImpulses gauss_seidel(const DenseContacts& contacts,
                           const ContactOptions& options,
                           Eigen::VectorXd start);

}  // namespace tetwarp::reference
