/// @file structure_global.hpp
/// Structure of a problem in global form.
#pragma once
#include "host/contact/structure/structure.hpp"

namespace tetwarp {

void fill_global_structure(const ContactProblem& problem,
                           const ContactSkipOptions& skip,
                           StructureStages& stages,
                           ContactStructure& structure);

}  // namespace tetwarp
