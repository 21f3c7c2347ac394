/// @file contact_rest.cpp
/// Finds bodies whose contacts slide, are held up, or have bonds that change.
#include "host/simulate/contact_step/contact_rest.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

constexpr double calm_bond_rate = 1e-6;  // of the intensity [1/s]
constexpr double calm_slip = 0.1;        // of the speed at which a body counts as at rest

/// Whether a contact slides: its friction is at its limit and its points move along each other.
bool slides(const SceneSurfaces& surfaces,
            const BodyLink& bodies,
            const double* impulse,
            const double* velocity) {
  const std::size_t a = index_of(bodies[0]), b = index_of(bodies[1]);
  const ContactMaterial& material =
      at(surfaces.materials, surfaces.material_of(bodies[0], bodies[1]));
  const bool is_at_limit =
      std::hypot(impulse[1], impulse[2]) >= (1 - 1e-6) * material.friction * impulse[0];
  const double size = std::min(surfaces.body_size[a], surfaces.body_size[b]);
  const double slip = calm_slip * rest_speed * size;
  return is_at_limit && std::hypot(velocity[1], velocity[2]) > slip;
}

}  // namespace

ContactRest contact_rest(const SceneSurfaces& surfaces,
                         const ContactHistory& history,
                         const std::vector<ContactPoint>& points,
                         const std::vector<double>& intensity_before,
                         const ContactSolution& solution,
                         const std::vector<double>& fractions) {
  ContactRest rest;
  rest.is_restless.assign(surfaces.surfaces.bodies.size(), 0);
  for (std::size_t b = 0; b < fractions.size(); ++b) rest.is_restless[b] = fractions[b] < 1;
  for (std::size_t c = 0; c < points.size(); ++c) {
    const BodyLink bodies = link_of((*history.contacts())[c].key);
    rest.links.push_back(bodies);
    const bool is_sliding =
        slides(surfaces, bodies, solution.impulse.data() + 3 * c, solution.velocity.data() + 3 * c);
    const double bonding = std::abs(points[c].intensity - intensity_before[c]);
    if (is_sliding || bonding > calm_bond_rate * history.time_step()) {
      for (const std::int32_t body : bodies) rest.is_restless[index_of(body)] = 1;
    }
  }
  return rest;
}

}  // namespace tetwarp
