/// @file bilateral.hpp
/// Elimination of bilateral rows. Part of back end `reference`.
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "host/reference/contact/dense.hpp"

namespace tetwarp::reference {

/// Eliminates the bilateral rows of a problem from contacts in global form.
/// @param system    A, factorized
/// @param jacobian  of the rows of `contacts`
/// @param offset    w of these rows
void eliminate_bilateral(const ContactProblem& problem,
                         const Eigen::LLT<Eigen::MatrixXd>& system,
                         const Eigen::MatrixXd& jacobian,
                         const Eigen::VectorXd& offset,
                         DenseContacts& contacts);

}  // namespace tetwarp::reference
