/// @file kept_places.cpp
/// Computes the places of a state that are not known yet.
#include "host/simulate/surfaces/kept_places.hpp"

#include <utility>

#include "host/simulate/surfaces/surface_motion.hpp"

namespace tetwarp {

const SurfacePlaces& KeptPlaces::of(const ModelState& state) {
  if (position_.empty() || position_ != state.position || rotation_ != state.rotation) {
    surface_places(scene_, model_, state, threads_, places_);
    position_ = state.position;
    rotation_ = state.rotation;
  }
  return places_;
}

void KeptPlaces::take(const ModelState& state, SurfacePlaces& places) {
  of(state);
  std::swap(places_, places);
  position_.clear();
}

}  // namespace tetwarp
