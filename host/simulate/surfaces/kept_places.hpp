/// @file kept_places.hpp
/// KeptPlaces: the places of all surfaces in a state.
#pragma once
#include <array>
#include <vector>

#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Computes the places again only if positions or rotations differ from those of the last call.
class KeptPlaces {
 public:
  /// @param scene, model  kept by the caller
  /// @param threads       any number: same places
  KeptPlaces(const SceneSurfaces& scene, const Model& model, int threads)
      : scene_(scene), model_(model), threads_(threads) {}

  /// @returns surface_places(), valid until the next call
  const SurfacePlaces& of(const ModelState& state);
  /// The same, moved to `places`; the memory that was there is kept for later calls.
  void take(const ModelState& state, SurfacePlaces& places);

 private:
  const SceneSurfaces& scene_;
  const Model& model_;
  int threads_;
  SurfacePlaces places_;
  std::vector<Point3> position_;  ///< of the state of the places; empty: none
  std::vector<std::array<double, 4>> rotation_;
};

}  // namespace tetwarp
