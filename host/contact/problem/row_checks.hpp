/// @file row_checks.hpp
/// Checks of rows beyond those of contacts.
#pragma once
#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// Checks of `second_friction`, `bilateral`, `rolling` and `expert`, for check_problem().
/// @pre the other members have passed their checks
/// @throws ContactProblemError
void check_row_blocks(const ContactProblem& problem);

}  // namespace tetwarp
