/// @file contact_rest.hpp
/// ContactRest: what contacts say about whether bodies are at rest.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_tracker.hpp>
#include <tetwarp/simulate.hpp>

#include "host/simulate/contact_step/body_link.hpp"
#include "host/simulate/contact_step/contact_history.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Below it a body counts as at rest [body sizes / s].
inline constexpr double rest_speed = 2e-3;

struct ContactRest {
  std::vector<BodyLink> links;            ///< of all contacts of the step
  std::vector<std::uint8_t> is_restless;  ///< [bodies, then obstacles] slides, or is held up, or
                                          ///< has a bond that changes; or empty: none
};

/// @param history           of a part that has ended
/// @param points            [contacts] at its end
/// @param intensity_before  [contacts] at its start
/// @param fractions         [bodies, then obstacles] of the part that each moved
ContactRest contact_rest(const SceneSurfaces& surfaces,
                         const ContactHistory& history,
                         const std::vector<ContactPoint>& points,
                         const std::vector<double>& intensity_before,
                         const ContactSolution& solution,
                         const std::vector<double>& fractions);

}  // namespace tetwarp
