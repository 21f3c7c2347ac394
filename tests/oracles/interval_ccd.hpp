/// @file interval_ccd.hpp
/// When two features without thickness may first meet: bisection of time and both coordinates of
/// the features, with bounds that no rounding can break. Slow; for tests.
///
/// The difference of the two points is linear in time and in each coordinate alone, so over a box
/// of these it lies in the box of its eight corner values, inflated by 64 units in the last place
/// of the largest coordinate (fewer than 52 roundings). Boxes whose bound excludes 0 are dropped.
#pragma once
#include <array>
#include <cstdint>

#include <tetwarp/volume.hpp>

namespace tetwarp::reference {

/// Four points that move straight from start to end.
struct PairMotion {
  std::array<Point3, 4> start, end;
};

struct IntervalHit {
  double time = 2;         ///< no meeting is earlier; 2: there is none
  std::int64_t boxes = 0;  ///< examined
};

/// Point 0 against the triangle 1, 2, 3.
/// @param tolerance  bounds that hold 0 and are smaller than this count as meetings [m], > 0
/// @param most_boxes  then the time reached counts as a meeting
IntervalHit interval_vertex_face(const PairMotion& pair, double tolerance, std::int64_t most_boxes);
/// Segment 0, 1 against segment 2, 3; the same.
IntervalHit interval_edge_edge(const PairMotion& pair, double tolerance, std::int64_t most_boxes);

}  // namespace tetwarp::reference
