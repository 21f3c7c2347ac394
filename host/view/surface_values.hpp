/// @file surface_values.hpp
/// SurfaceValues: stress, gap and adhesion at the points of surfaces, to be drawn as colors.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>
#include <tetwarp/surface.hpp>

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
  /// @param simulator  kept by the caller
  explicit SurfaceValues(const Simulator& simulator) : simulator_(simulator) {}

  /// Of the state now: von Mises stress [Pa] of bodies of tetrahedra; the smallest gap [m] and the
  /// largest adhesion intensity of the contacts at a point. Where a body does not touch with a
  /// vertex, that is the one next to the contact.
  /// @returns [bodies][points of the surface], not a number where there is no value; empty for none
  std::vector<std::vector<float>> of(SurfaceQuantity quantity);

 private:
  std::vector<std::vector<float>> stresses();
  std::vector<std::vector<float>> of_contacts(SurfaceQuantity quantity) const;

  const Simulator& simulator_;
  std::vector<BoundPoints> bindings_;  ///< [bodies], made when they are first needed
};

}  // namespace tetwarp::view
