/// @file residual.hpp
/// residual_of() with the numbers of each block of three rows.
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/measure.hpp"

namespace tetwarp {

/// Blocks are those of BlockProblem, with the contacts first.
struct BlockResiduals {
  ContactResidual residual;
  std::vector<double> share;              ///< of each block in eta
  std::vector<MeasuredContact> contacts;  ///< with diagonal blocks and pushes
  Eigen::VectorXd impulse;                ///< [3 blocks]
  Eigen::VectorXd velocity;               ///< [3 blocks]
};

/// Of a problem that has passed its checks and needs no BlockProblem.
BlockResiduals residuals_of_blocks(const ContactProblem& problem,
                                   std::span<const double> impulse,
                                   std::span<const double> body_velocity,
                                   const ContactOptions& options);

/// Of any problem; arguments and errors as those of residual_of().
BlockResiduals residuals_of(const ContactProblem& problem,
                            const ContactSolution& solution,
                            const ContactOptions& options);

}  // namespace tetwarp
