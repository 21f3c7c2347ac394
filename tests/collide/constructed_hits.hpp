/// @file constructed_hits.hpp
/// Pairs of features whose first or later meeting is known because they are made from it.
#pragma once
#include <array>
#include <random>
#include <vector>

#include "kernels/collide/pair_ccd.hpp"

#include <tetwarp/volume.hpp>

namespace tetwarp::test {

/// Four points that move straight: a vertex and a face, or two edges.
struct MovingPair {
  std::array<Point3, 4> start{}, end{};
  double time = 2;  ///< at which they meet, up to rounding
  double size = 1;  ///< of the features and their motion [m]

  MovingPoints points() const;
};

enum class HitKind {
  generic,
  tiny,             ///< a millionth of the size
  translation,      ///< both features keep their shape and direction
  at_vertex,        ///< of the face; edges meet at their ends
  at_edge,          ///< of the face; one edge meets with its end
  grazing,          ///< nearest at 1e-12, and moving along
  offset_1e3,       ///< coordinates
  offset_1e6,       ///< coordinates
  at_end,           ///< meets at time 1 exactly
  coplanar_flat,    ///< all in the plane z = 0
  coplanar_tilted,  ///< all in another plane
  degenerate        ///< the face is a segment; the edges are parallel, on one line when they meet
};
extern const std::vector<HitKind> all_hit_kinds;
const char* name_of(HitKind kind);

MovingPair constructed_hit(HitKind kind, bool edges, std::mt19937_64& random);

/// Points and motions from a normal distribution, of which few pairs meet.
MovingPair random_pair(std::mt19937_64& random);

/// The result for a pair of edges, or of a vertex and a face.
CcdResult ccd_of(const MovingPair& pair, bool edges, const CcdLimits& limits);

/// Distance at a time, by nested search in extended precision: shares no formula with the kernels.
double searched_distance(const std::array<Point3, 4>& points, bool edges);
std::array<Point3, 4> places_at(const MovingPair& pair, double time);

}  // namespace tetwarp::test
