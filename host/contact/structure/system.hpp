/// @file system.hpp
/// The numbers of a contact problem in the order of its structure, in memory of the host.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/input.hpp"
#include "host/contact/structure/structure.hpp"
#include "host/exec/contact_exec_cpu.hpp"
#include "kernels/contact/contact_system.hpp"

namespace tetwarp {

template <class T>
using ContactSystem = SystemMemory<CpuContactExec, T>;

ContactChoices choices_of(const ContactOptions& options);

/// The system of a problem, in float64.
/// @param structure  of this problem or one of the same pattern
/// @param savings    out
void fill_system(const ContactProblem& problem,
                 const ContactOptions& options,
                 const ContactStructure& structure,
                 ContactSystem<double>& system,
                 ContactSavings& savings,
                 int threads = 1);

/// The same numbers, rounded.
ContactSystem<float> make_float32(const ContactStructure& structure, ContactSystem<double>& system);

}  // namespace tetwarp
