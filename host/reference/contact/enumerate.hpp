/// @file enumerate.hpp
/// All solutions of a small problem. Part of back end `reference`.
#pragma once
#include <vector>

#include <Eigen/Core>

#include "host/reference/contact/dense.hpp"

namespace tetwarp::reference {

/// Impulses of the solutions of a pyramid or frictionless problem, one for each velocity. All
/// combinations of open, sticking and sliding contacts are tried: in each the laws are a linear
/// system, whose solution is kept if it satisfies all laws.
/// @pre mode_count(contacts, options) is finite; the cost is proportional to it
std::vector<Eigen::VectorXd> enumerate_impulses(const DenseContacts& contacts,
                                                const ContactOptions& options);

/// Linear systems that enumerate_impulses() solves; infinity for laws that are not piecewise
/// linear.
double mode_count(const DenseContacts& contacts, const ContactOptions& options);

}  // namespace tetwarp::reference
