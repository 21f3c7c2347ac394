/// @file surface_values.hpp
/// SurfaceValues: stress, gap and adhesion at the points of surfaces, to be drawn as colors.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>
#include <tetwarp/surface.hpp>

#include "host/view/look/look_surfaces.hpp"

namespace tetwarp::view {

enum class SurfaceQuantity : std::uint8_t { none, stress, gap, adhesion };

/// Of an option; none for other words.
SurfaceQuantity quantity_of(const std::string& word);

/// With its unit, for a legend.
std::string title_of(SurfaceQuantity quantity);

/// Of each point the mean of its four nodes by their weights, of a node that of its tetrahedra by
/// their volumes.
/// @param values   one per tetrahedron
/// @param binding  of the points to the nodes of the mesh
std::vector<float> surface_means(const Mesh& mesh,
                                 const std::vector<double>& values,
                                 const BoundPoints& binding);

class SurfaceValues {
 public:
  /// @param simulator, looks  kept by the caller
  SurfaceValues(const Simulator& simulator, const LookSurfaces& looks)
      : simulator_(simulator), looks_(looks) {}

  /// Of the state now: von Mises stress [Pa] of bodies of tetrahedra; the smallest gap [m] and the
  /// largest adhesion intensity of the contacts at a point. Where a body does not touch with a
  /// vertex, that is the one next to the contact. Points of a surface for the eye have the values
  /// of the nearest points, at rest, of the one that touches.
  /// @returns [bodies][points of what is drawn], not a number where there is no value; empty for
  ///          none
  std::vector<std::vector<float>> of(SurfaceQuantity quantity);

 private:
  std::vector<std::vector<float>> stresses();
  std::vector<std::vector<float>> of_contacts(SurfaceQuantity quantity);
  void show_looks(std::vector<std::vector<float>>& values);

  const Simulator& simulator_;
  const LookSurfaces& looks_;
  // Made when they are first needed:
  std::vector<BoundPoints> bindings_;  ///< [bodies]
  /// [bodies][points of a surface for the eye]: the nearest point of the one that touches.
  std::vector<std::vector<std::size_t>> touching_;
};

}  // namespace tetwarp::view
