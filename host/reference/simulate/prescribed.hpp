/// @file prescribed.hpp
/// Where scripts, paths and callers put what has no unknowns, and the anchors of handles.
#pragma once
#include <optional>
#include <vector>

#include "host/reference/simulate/motion.hpp"
#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {

/// Fixed nodes are not among them: they stay where they are.
struct Prescribed {
  std::vector<std::optional<Vector3d>> nodes;    ///< [nodes]
  std::vector<std::optional<Placement>> frames;  ///< [rigids]
  std::vector<std::optional<Vector3d>> handles;  ///< [handles] displacement; nothing: released
};

Prescribed prescribed_at(const System& system, const Overrides& overrides, double end_time);

}  // namespace tetwarp::reference
