/// @file contact_extract.hpp
/// An island of a contact problem as a problem of its own.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact_structure.hpp"

namespace tetwarp {

/// The same form, contacts and dofs in the order of the island.
ContactProblem make_island_problem(const ContactProblem& problem,
                                   const ContactStructure& structure,
                                   const ContactIsland& island);

/// Entries of `values` (`width` each) at `order`.
std::vector<double> gathered(const std::vector<double>& values,
                             std::int64_t width,
                             const std::int32_t* order,
                             std::int64_t count);

}  // namespace tetwarp
