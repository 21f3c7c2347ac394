/// @file state_view.hpp
/// A state and velocities in memory of the host, as the stages of surfaces read them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/model/model.hpp"
#include "kernels/body/surface_move.hpp"

namespace tetwarp {

/// @param state  kept by the caller
inline SurfaceState view_of_state(const ModelState& state, std::int32_t node_count) {
  const auto* const position = reinterpret_cast<const double*>(state.position.data());
  const std::int64_t nodes = 3 * std::int64_t{node_count};
  return {{position, nodes},
          {position + nodes, 3 * static_cast<std::int64_t>(state.position.size()) - nodes},
          {reinterpret_cast<const double*>(state.rotation.data()),
           4 * static_cast<std::int64_t>(state.rotation.size())}};
}
/// @param velocity, fraction  kept by the caller; see SurfaceVelocity
inline SurfaceVelocity view_of_velocity(const std::vector<Point3>& velocity,
                                        std::int32_t node_count,
                                        double time_step,
                                        std::span<const double> fraction) {
  return {{reinterpret_cast<const double*>(velocity.data()),
           3 * static_cast<std::int64_t>(velocity.size())},
          node_count,
          time_step,
          {fraction.data(), static_cast<std::int64_t>(fraction.size())}};
}

}  // namespace tetwarp
