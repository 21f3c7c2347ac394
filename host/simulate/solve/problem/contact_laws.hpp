/// @file contact_laws.hpp
/// Copies friction, offsets, adhesion and guess of some of the contacts of a step.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// Copies the laws of some contacts; reads and changes nothing else.
/// @param contacts  numbers of contacts of `from`
void gather_laws(const std::vector<std::int32_t>& contacts,
                 const ContactProblem& from,
                 ContactProblem& to);

}  // namespace tetwarp
