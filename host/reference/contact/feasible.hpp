/// @file feasible.hpp
/// Whether some velocity satisfies all contacts. Part of back end `reference`.
#pragma once
#include "host/reference/contact/dense.hpp"

namespace tetwarp::reference {

/// Whether impulses exist that make every u_n >= 0.
bool is_feasible(const DenseContacts& contacts);

}  // namespace tetwarp::reference
