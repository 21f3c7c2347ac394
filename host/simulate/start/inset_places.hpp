/// @file inset_places.hpp
/// InsetPlaces: surfaces without the rounding of their coordinates.
#pragma once
#include <cstdint>
#include <vector>

#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

/// Places of surfaces that are moved inwards by the rounding of their coordinates. Surfaces that
/// touch from outside, as decimals of a file put them, are apart there and face each other;
/// surfaces that intersect by more than rounding still do.
///
/// The rounding of a body is 1e-9 of its largest coordinate, at most a tenth of the thickness.
/// Meshes with an outside are moved: closed ones, and open ones of rigid bodies and obstacles.
/// Sheets that deform, round bodies and planes stay.
class InsetPlaces {
 public:
  /// @param surfaces, given  kept by the caller
  InsetPlaces(const CollisionSurfaces& surfaces, const SurfacePlaces& given);

  const SurfacePlaces& places() const { return places_; }
  const SurfacePlaces& given() const { return given_; }
  double rounding(std::int32_t body) const;  ///< [m]; 0 of a plane
  bool is_inset(std::int32_t body) const;
  bool is_closed(std::int32_t body) const;  ///< its triangles are the border of a volume

 private:
  void set_rounding(std::size_t body);
  void move_inwards(const CollisionBody& body, double rounding);
  bool has_border(const CollisionBody& body) const;

  const CollisionSurfaces& surfaces_;
  const SurfacePlaces& given_;
  SurfacePlaces places_;
  std::vector<double> rounding_;         ///< [bodies] [m]
  std::vector<std::uint8_t> is_closed_;  ///< [bodies]
};

}  // namespace tetwarp
