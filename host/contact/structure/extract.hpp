/// @file extract.hpp
/// An island of a contact problem as a problem of its own.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact/structure/structure.hpp"
#include "kernels/contact/contact_residual.hpp"

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

/// Impulses of an island from its slots to the contacts of the problem.
/// @param from  [3 slots of the island]
void scatter_impulses(const ContactStructure& structure,
                      const ContactIsland& island,
                      const double* from,
                      std::vector<double>& to);

/// Velocities of an island from its places to the dofs of the problem.
/// @param from  [dofs of the island]
void scatter_velocities(const ContactStructure& structure,
                        const ContactIsland& island,
                        const double* from,
                        std::vector<double>& to);

/// The slot of the largest term, counted from `first_slot`, becomes its contact.
void to_problem_index(const ContactStructure& structure,
                      std::int64_t first_slot,
                      ContactSums& sums);

}  // namespace tetwarp
