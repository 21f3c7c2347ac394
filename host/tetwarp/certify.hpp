/// @file certify.hpp
/// Proofs that moving triangle meshes do not intersect, or that they do, for the output of any
/// simulation.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// A triangle mesh at two states. In between every point moves straight, all at the same rate.
struct MovingSurface {
  std::vector<Point3> start, end;                      ///< of as many points [world]
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< indices; of any shape, also flat
};

struct CertifyOptions {
  bool self = true;  ///< also triangles of one surface that share no point of it
  /// Parts of time that are examined for a pair of triangles; then it is undecided.
  std::int64_t most_intervals = 1 << 14;
  int threads = 0;  ///< up to 1024; 0: all cores. Any number gives the same result
};

enum class Verdict {
  free,      ///< proved: the closed triangles have no point in common at any time from 0 to 1
  meets,     ///< proved: they have one at time CertifiedPair::until
  undecided  ///< neither, see CertifiedPair
};

/// Two triangles that meet or may meet. Time is 0 at the start and 1 at the end.
struct CertifiedPair {
  std::array<std::int32_t, 2> surfaces, triangles;
  Verdict verdict = Verdict::undecided;
  /// Proved: they do not meet before `from`. `meets`: they do at `until`, a multiple of 2^-40, so
  /// that they first meet between these. `undecided`: they do not meet after `until` either.
  double from = 0, until = 1;

  auto operator<=>(const CertifiedPair&) const = default;
};

struct Certificate {
  Verdict verdict = Verdict::free;   ///< meets: a pair does; else undecided: a pair is; else free
  std::vector<CertifiedPair> pairs;  ///< all pairs that are not free, by surfaces, then triangles
  std::int64_t near_pairs = 0;       ///< pairs of triangles whose motions have overlapping boxes
  std::int64_t intervals = 0;        ///< parts of time examined for them
};

/// Examines all pairs of triangles of different surfaces, and with CertifyOptions::self of the
/// same.
///
/// Of a part of time in which a direction separates both triangles at its beginning and its end,
/// they are free: a difference of two points that move straight is linear in time. Directions and
/// distances are rounded, the bound of what that changes is subtracted. Other parts are halved.
/// That triangles meet is decided at times that are multiples of 2^-40, in exact integers where
/// rounding could matter. At the start and the end every pair is decided, also where triangles only
/// touch. On the way, a pair is undecided only where within 2^-40 of the time no direction
/// separates it and it does not meet at a multiple of 2^-40 either, as where triangles touch for a
/// moment and part again; or after CertifyOptions::most_intervals parts.
///
/// Source: separating directions of convex shapes; the bounds and the exact decision are ours.
/// @throws std::invalid_argument  start and end differ in size, coordinates that are not finite or
///         above 1e150, indices out of range, options out of range
TETWARP_EXPORT Certificate certify(std::span<const MovingSurface> surfaces,
                                   const CertifyOptions& options = {});

}  // namespace tetwarp
