/// @file moving_triangles.hpp
/// Whether and when two triangles whose points move straight meet, with proof.
#pragma once
#include <array>
#include <cstdint>

#include <tetwarp/certify.hpp>

namespace tetwarp {

/// Six points, three of each triangle, at the start and the end.
struct TrianglePairMotion {
  std::array<Point3, 6> start, end;
};

/// Times are counted in steps of 2^-time_bits of the motion.
inline constexpr int time_bits = 40;
inline constexpr std::int64_t end_of_time = std::int64_t{1} << time_bits;

/// Whether both closed triangles certainly have no point in common from time `from` to `until`;
/// false says nothing.
bool are_separated(const TrianglePairMotion& pair, std::int64_t from, std::int64_t until);

/// Whether both closed triangles have a point in common at a time; exact, also for flat triangles
/// and those that only touch.
///
/// They do not if and only if a direction separates them strictly. If there is one, there is one
/// among these: the edges and the difference w of two points, one of each triangle; the normals of
/// pairs of these; and the products of a normal and an edge or w. For the differences of points of
/// both triangles form a convex polytope. If 0 lies within the space that it spans, one of its
/// facets separates 0 from it, and facets are spanned by edges; if not, the part of w that is
/// normal to this space does.
bool do_intersect(const TrianglePairMotion& pair, std::int64_t time);

/// A part of time, its verdict, and how many parts it was divided into.
struct PairVerdict {
  Verdict verdict;
  std::int64_t from, until;  ///< as CertifiedPair, in steps
  std::int64_t intervals;
};

/// The verdict on a whole motion.
PairVerdict judge(const TrianglePairMotion& pair, std::int64_t most_intervals);

}  // namespace tetwarp
