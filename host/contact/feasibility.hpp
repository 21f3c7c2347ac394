/// @file feasibility.hpp
/// Whether any velocity keeps all contacts of a problem apart.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/structure/structure.hpp"
#include "host/contact/structure/system.hpp"

namespace tetwarp {

/// Slots of an island whose normal offsets contradict each other; empty when none do.
///
/// For y >= 0 every velocity that meets all contacts differs from the free one by at least
/// -y.q / sqrt(y.B y) in the energy norm. Frictionless sweeps of a contradiction grow without end
/// along a y that makes this infinite: then these are the contacts where y pushes.
/// @param budget  sweeps at most
/// @pre A does not couple the island's blocks
std::vector<std::int64_t> contradicting_slots(const ContactStructure& structure,
                                              const ContactSystem<double>& system,
                                              const ContactIsland& island,
                                              std::int64_t budget);

}  // namespace tetwarp
