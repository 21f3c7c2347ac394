/// @file system.hpp
/// The numbers of a contact problem in the order of its structure, in host memory.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/input.hpp"
#include "host/contact/structure/structure.hpp"
#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/contact_system.hpp"

namespace tetwarp {

template <class T>
using ContactSystem = SystemMemory<CpuExec, T>;

/// The options that the stage "setup" reads.
ContactChoices choices_of(const ContactOptions& options);

/// Fills `system` with the numbers of a problem, in float64.
/// @param structure  of this problem or of one with the same pattern
/// @param savings    out: rows and springs that were left out
void fill_system(const ContactProblem& problem,
                 const ContactOptions& options,
                 const ContactStructure& structure,
                 ContactSystem<double>& system,
                 ContactSavings& savings,
                 int threads = 1);

/// The same numbers, rounded to float32.
ContactSystem<float> make_float32(const ContactStructure& structure, ContactSystem<double>& system);

}  // namespace tetwarp
