/// @file fclib_rows.hpp
/// Rows of FCLIB files beyond those of contacts.
#pragma once
#include <tetwarp/contact_problem.hpp>

#include "io/fclib/fclib_numbers.hpp"
#include "io/h5/h5.hpp"

namespace tetwarp::fclib {

/// Bilateral rows: FCLIB's G and b.
/// @param dofs  of the problem
BilateralRows read_bilateral(const h5::Object& root, const Expected& dofs);

/// What FCLIB has no place for: the groups /friction, /bilateral and /rolling. Those that are
/// missing leave the problem as it is.
void read_extensions(const h5::Object& file, ContactProblem& problem);

/// Impulses of these rows, from a solution or a guess; missing ones stay empty.
void read_row_guesses(const h5::Object& group, ContactProblem& problem);

/// Writes G and b.
void write_bilateral(const h5::Object& root, const h5::Object& vectors, const BilateralRows& rows);

/// Writes the groups that read_extensions() reads.
void write_extensions(const h5::Object& file, const ContactProblem& problem);

}  // namespace tetwarp::fclib
