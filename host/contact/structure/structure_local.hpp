/// @file structure_local.hpp
/// Structure of a problem in local form.
#pragma once
#include <cstdint>

#include "host/contact/structure/structure.hpp"

namespace tetwarp {

void fill_local_structure(const ContactProblem& problem,
                          const ContactSkipOptions& skip,
                          StructureStages& stages,
                          ContactStructure& structure);
void fill_dense_structure(std::int64_t contacts, ContactStructure& structure);

}  // namespace tetwarp
