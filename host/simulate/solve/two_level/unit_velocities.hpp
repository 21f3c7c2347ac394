/// @file unit_velocities.hpp
/// How the nodes that a group of contacts touches give way to one of these contacts.
#pragma once
#include <cstddef>

#include "host/simulate/solve/two_level/elastic_groups.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"

namespace tetwarp {

/// Velocities z of the nodes of the contact's group for unit impulses along its three axes.
/// @param z  out, [3][size of the group]
void set_unit_velocities(const TouchingBlocks& blocks,
                         ElasticGroups& groups,
                         std::size_t contact,
                         float* z);

}  // namespace tetwarp
