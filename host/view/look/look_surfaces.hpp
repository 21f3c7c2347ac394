/// @file look_surfaces.hpp
/// LookSurfaces: fine surfaces for the eye, of bodies that touch with others.
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include <tetwarp/simulate.hpp>
#include <tetwarp/surface.hpp>

namespace tetwarp::view {

/// The surfaces that scenes give as meshes of bodies with a lattice and a `surface` of another
/// kind. Their points are bound to the tetrahedra.
class LookSurfaces {
 public:
  /// @param simulator  must outlive this
  explicit LookSurfaces(const Simulator& simulator);

  /// Of a body, in the frame of its geometry; null: it has none.
  const Surface* of(std::size_t body) const { return surfaces_[body]; }
  /// The surface that is drawn of a body: that for the eye, else the one that touches.
  const Surface& drawn(std::size_t body) const;
  /// Where its points are now [world].
  std::vector<Point3> positions(std::size_t body) const;
  /// How its points follow the nodes. @pre the body has tetrahedra
  BoundPoints binding(std::size_t body) const;

 private:
  const Simulator& simulator_;
  std::vector<const Surface*> surfaces_;           ///< [bodies]
  std::vector<std::optional<BoundPoints>> bound_;  ///< [bodies]
};

}  // namespace tetwarp::view
