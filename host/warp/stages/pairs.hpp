/// @file pairs.hpp
/// The stages from node positions to the sorted (cell, tetrahedron) pairs, for any executor.
#pragma once
#include <type_traits>

#include "host/warp/stages/pairs_device.hpp"
#include "host/warp/stages/pairs_host.hpp"

namespace tetwarp {

/// Computes and holds the pairs of the current step and of the one before.
template <class Exec>
using WarpPairs = std::conditional_t<Exec::reads_are_free, HostPairs<Exec>, DevicePairs<Exec>>;

}  // namespace tetwarp
