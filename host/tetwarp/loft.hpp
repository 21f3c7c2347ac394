/// @file loft.hpp
/// Lofts: smooth closed tubes through elliptical cross-sections, as surfaces and as tetrahedra.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/scene_parts.hpp>

namespace tetwarp {

/// An elliptical cross-section at right angles to the center line.
struct LoftStation {
  Point3 center{0, 0, 0};             ///< [m]
  std::array<double, 2> radii{1, 1};  ///< [m], > 0
  /// Towards the first radius, made perpendicular to the center line; zero: that of the station
  /// before, turned as the center line turns; of the first station any.
  Point3 direction{0, 0, 0};
};

/// A tube through its stations in order. The center line goes through their centers with a steady
/// tangent; radii and direction change smoothly from station to station, radii without passing
/// those beside them. Both ends are closed by half ellipsoids.
struct LoftTube {
  std::vector<LoftStation> stations;  ///< two or more
  std::array<double, 2> ends{1, 1};   ///< lengths of the half ellipsoids [m], > 0
};

/// Volume of a tube [m^3]: the integral of pi a b along the center line, and its ends.
/// @throws std::invalid_argument  naming the station: fewer than two, radii or ends not above 0,
///         centers that coincide, a direction along the center line, a center line that bends so
///         much that cross-sections meet, or a tube more than 10,000 times as long as its largest
///         radius or shorter than a 10,000th of it
TETWARP_EXPORT double loft_volume(const LoftTube& tube);

/// Closed triangle surfaces of tubes, outwards, of about `triangles` triangles in all, with points
/// on the tubes and on the ellipse of each station. Tubes may overlap; each keeps its surface.
/// @param triangles  4 to 10 million
/// @throws std::invalid_argument  as loft_volume(), no tube, or `triangles` out of range
TETWARP_EXPORT Surface make_loft_surface(const std::vector<LoftTube>& tubes,
                                         std::int64_t triangles = 1280);

/// Cells of five tetrahedra that follow the tube, along its center line, its first and its second
/// radius. They contain it up to a twentieth of its smallest radius, if there are enough cells
/// along its bends, and have more volume: from about 1.1 times that of the tube (4 x 4 cells
/// across, long) to 2 times (one cell across, short).
/// @throws std::invalid_argument  as loft_volume(), an invalid lattice, or cells that fold
TETWARP_EXPORT Mesh make_loft_mesh(const LoftTube& tube, const Lattice& lattice);

}  // namespace tetwarp
