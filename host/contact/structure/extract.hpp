/// @file extract.hpp
/// An island of a contact problem as a separate problem, and the copy of its solution back to the
/// order of the whole problem.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact/structure/structure.hpp"
#include "kernels/contact/contact_residual.hpp"

namespace tetwarp {

/// The contacts, bodies and adhesion of an island, in the form of the whole problem and in the
/// order of the structure's slots and places.
ContactProblem make_island_problem(const ContactProblem& problem,
                                   const ContactStructure& structure,
                                   const ContactIsland& island);

/// The entries order[0] .. order[count - 1] of `values`, `width` numbers each; empty where `values`
/// is empty.
std::vector<double> gathered(const std::vector<double>& values,
                             std::int64_t width,
                             const std::int32_t* order,
                             std::int64_t count);

/// Copies the impulses of an island to the order of the problem.
/// @param from  [3 slots of the island]
/// @param to    [3 contacts]
void scatter_impulses(const ContactStructure& structure,
                      const ContactIsland& island,
                      const double* from,
                      std::vector<double>& to);

/// Copies the body velocities of an island to the order of the problem.
/// @param from  [dofs of the island]
/// @param to    [dofs]
void scatter_velocities(const ContactStructure& structure,
                        const ContactIsland& island,
                        const double* from,
                        std::vector<double>& to);

/// Replaces sums.largest_contact, a slot relative to `first_slot`, by the index in the problem.
void to_problem_index(const ContactStructure& structure,
                      std::int64_t first_slot,
                      ContactSums& sums);

}  // namespace tetwarp
