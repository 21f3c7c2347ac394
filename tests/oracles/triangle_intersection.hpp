/// @file triangle_intersection.hpp
/// Which triangles intersect, exactly: the judge of "no two bodies ever intersect".
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp::reference {

using Triangle = std::array<Point3, 3>;

/// Whether two closed triangles have a point in common; also flat ones, needles, points and pairs
/// in one plane. Exact for coordinates as in orientation() (exact_sign.hpp).
bool triangles_intersect(const Triangle& a, const Triangle& b);

struct TriangleSet {
  std::vector<Point3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Pairs (triangle of a, triangle of b) that intersect, sorted.
/// @throws std::invalid_argument  an index is out of range or a coordinate is not finite
std::vector<std::array<std::int32_t, 2>> intersecting_triangles(const TriangleSet& a,
                                                                const TriangleSet& b);

/// Pairs (i, k), i < k, of one set that intersect, sorted. Triangles that share a point of the set
/// are left out.
/// @throws std::invalid_argument  as above
std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleSet& set);

/// Pairs (set i, set k), i < k, of which some triangles intersect, sorted.
/// @throws std::invalid_argument  as above
std::vector<std::array<std::int32_t, 2>> intersecting_sets(const std::vector<TriangleSet>& sets);

}  // namespace tetwarp::reference
