/// @file facet_parts.hpp
/// Flat convex facets of bodies in the source, cut into their parts in its voxels.
///
/// By the divergence theorem, the part of a body at x in [a, a + 1] within a bar of voxels along x
/// has the volume of the integral of min(max(x - a, 0), 1) over its surface, dA the area projected
/// along x. A part of the surface within one voxel adds its area to all voxels before it along x,
/// and its first moment to its own.
#pragma once
#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetwarp {

/// A convex polygon of corners with `size` coordinates.
template <int size>
struct Polygon {
  struct Corner {
    double x[size];
  };
  /// Most corners of a part of a tetrahedron's face: three, and two for each of the three axes of
  /// the output and two of the source, one for the last. Of its section with a plane, one less.
  static constexpr int max_count = 14;
  /// While a polygon is cut, every second corner may be on the other side by rounding: each then
  /// has two crossings beside it.
  static constexpr int capacity = max_count + max_count / 2;

  int count = 0;
  Corner corner[capacity];

  void append(const Corner& one) { corner[count++] = one; }
  bool has_area() const { return count > 2; }
};

inline int floor_of(double x) {
  const int whole = static_cast<int>(x);
  return whole - (x < whole ? 1 : 0);
}

/// Where an edge crosses the plane at which a coordinate is `plane`. Does not depend on the
/// direction in which the edge is followed.
template <int axis, int size>
typename Polygon<size>::Corner cut_edge(const typename Polygon<size>::Corner& low,
                                        const typename Polygon<size>::Corner& high,
                                        double plane) {
  const double share = (plane - low.x[axis]) / (high.x[axis] - low.x[axis]);
  typename Polygon<size>::Corner cut;
  for (int n = 0; n < size; ++n) cut.x[n] = low.x[n] + share * (high.x[n] - low.x[n]);
  cut.x[axis] = plane;
  return cut;
}

/// Which corners of a polygon count as above a plane if its boundary may cross the plane only
/// twice: from the highest corner on, those before the first one below; from the lowest on, those
/// from the first one above on. The others are in the plane to within rounding.
/// @pre some corners are above the plane and some below
template <int axis, int size>
std::array<bool, Polygon<size>::capacity> above_of_chains(const Polygon<size>& from, double plane) {
  int top = 0, bottom = 0;
  for (int c = 1; c < from.count; ++c) {
    if (from.corner[c].x[axis] > from.corner[top].x[axis]) top = c;
    if (from.corner[c].x[axis] < from.corner[bottom].x[axis]) bottom = c;
  }
  std::array<bool, Polygon<size>::capacity> above = {};
  bool is_above = true, is_rising = false;
  for (int n = 0, c = top; n < from.count; ++n, c = c + 1 == from.count ? 0 : c + 1) {
    is_rising = is_rising || c == bottom;
    const bool is_there = from.corner[c].x[axis] >= plane;
    is_above = is_rising ? is_above || is_there : is_above && is_there;
    if (c == bottom) is_above = false;
    above[static_cast<std::size_t>(c)] = is_above;
  }
  return above;
}

/// Cuts a polygon at a plane into the corners for which is_above(c) is true and the others.
/// @pre there are at most max_count corners
/// @param below  out; null: not wanted
/// @returns how often the boundary crosses the plane
template <int axis, int size, class IsAbove>
int cut_by(const Polygon<size>& from,
           double plane,
           const IsAbove& is_above,
           Polygon<size>* below,
           Polygon<size>& above) {
  using Corner = typename Polygon<size>::Corner;
  assert(from.count <= Polygon<size>::max_count);  // no array is overrun
  int below_count = 0, above_count = 0, crossings = 0;
  const Corner* last = &from.corner[from.count - 1];
  bool was_above = is_above(from.count - 1);
  for (int c = 0; c < from.count; ++c) {
    const Corner* const now = &from.corner[c];
    const bool is_now = is_above(c);
    if (is_now != was_above) {
      const Corner cut = cut_edge<axis, size>(is_now ? *last : *now, is_now ? *now : *last, plane);
      if (below != nullptr) below->corner[below_count++] = cut;
      above.corner[above_count++] = cut;
      ++crossings;
    }
    if (is_now) {
      above.corner[above_count++] = *now;
    } else if (below != nullptr) {
      below->corner[below_count++] = *now;
    }
    last = now;
    was_above = is_now;
  }
  if (below != nullptr) below->count = below_count;
  above.count = above_count;
  return crossings;
}

/// Cuts a polygon at the plane where a coordinate is `plane`. Corners in the plane are above it.
/// Each part has at most one corner more than the polygon.
/// @param below  out; null: not wanted
template <int axis, int size>
void cut_polygon(const Polygon<size>& from,
                 double plane,
                 Polygon<size>* below,
                 Polygon<size>& above) {
  const auto is_above = [&](int c) { return from.corner[c].x[axis] >= plane; };
  if (cut_by<axis>(from, plane, is_above, below, above) <= 2) return;
  const auto chains = above_of_chains<axis>(from, plane);
  const auto is_of_chain = [&](int c) { return chains[static_cast<std::size_t>(c)]; };
  cut_by<axis>(from, plane, is_of_chain, below, above);
}

/// First and last of the intervals [n, n + 1] that a coordinate of a polygon is in.
struct IntervalRange {
  int first, last;

  template <int size>
  IntervalRange(const Polygon<size>& polygon, int axis) {
    double low = polygon.corner[0].x[axis], high = low;
    for (int c = 1; c < polygon.count; ++c) {
      const double x = polygon.corner[c].x[axis];
      low = x < low ? x : low;
      high = x > high ? x : high;
    }
    first = floor_of(low);
    last = std::max(first, -floor_of(-high) - 1);
  }
};

/// Calls visit(n, part) for the parts of a polygon in the intervals [n, n + 1] of a coordinate, n
/// from `begin` to `end` - 1. What a part is does not depend on which others are visited, if
/// `begin` is the same.
template <int axis, int size, class Visit>
void for_intervals(
    const Polygon<size>& polygon, IntervalRange range, int begin, int end, const Visit& visit) {
  if (range.first >= end || range.last < begin) return;
  Polygon<size> part, memory[2];
  const Polygon<size>* rest = &polygon;
  if (range.first < begin) {
    cut_polygon<axis>(*rest, begin, &part, memory[1]);
    rest = &memory[1];
    range.first = begin;
  }
  for (int n = range.first; n < range.last && n < end && rest->has_area(); ++n) {
    Polygon<size>& above = memory[(n - range.first) & 1];
    cut_polygon<axis>(*rest, n + 1, &part, above);
    if (part.has_area()) visit(n, part);
    rest = &above;
  }
  if (range.last < end && rest->has_area()) visit(range.last, *rest);
}

/// The part of a facet in a voxel of the source.
struct FacetPart {
  std::int32_t voxel[3];
  double area;    ///< projected along x, positive where the normal is [voxel^2]
  double moment;  ///< the integral of x - voxel[0] over it [voxel^3]
};

/// Parts of facets, in the order in which they were added.
class FacetParts {
 public:
  void clear() { parts_.clear(); }
  std::int64_t size() const { return static_cast<std::int64_t>(parts_.size()); }
  const FacetPart* data() const { return parts_.data(); }

  /// Adds the parts of a facet. Voxel n of the source along an axis is [n, n + 1].
  /// @param origin  of the corners [voxel]
  /// @param ranges  of the facet
  void add(const Polygon<3>& facet, const IntervalRange (&ranges)[3], const int* origin) {
    along<2>(facet, ranges, [&](int k, const Polygon<3>& layer) {
      along<1>(layer, ranges, [&](int j, const Polygon<3>& bar) {
        const IntervalRange range =
            ranges[0].first == ranges[0].last ? ranges[0] : IntervalRange(bar, 0);
        const int voxel[3] = {origin[0] + range.first, origin[1] + j, origin[2] + k};
        add_along(bar, range, voxel);
      });
    });
  }

  /// Adds a facet as if it were in one voxel; it may extend beyond it.
  /// @param x  of the voxel, from the origin of the corners
  void add_part(const Polygon<3>& part, int x, const int* voxel) {
    add(moments_of(part, x), voxel);
  }

 private:
  struct Moments {
    double area, moment;
  };

  /// Area, and the integral of the distance from a plane along x.
  static Moments moments_of(const Polygon<3>& part, int plane) {
    const double* const o = part.corner[0].x;
    const double from = o[0] - 3.0 * plane;
    double area = 0, moment = 0;
    double ax = part.corner[1].x[0], ay = part.corner[1].x[1] - o[1],
           az = part.corner[1].x[2] - o[2];
    for (int c = 2; c < part.count; ++c) {  // triangles at the first corner
      const double* const b = part.corner[c].x;
      const double by = b[1] - o[1], bz = b[2] - o[2];
      const double twice = ay * bz - az * by;
      area += twice;
      moment += twice * (ax + b[0] + from);
      ax = b[0];
      ay = by;
      az = bz;
    }
    return {0.5 * area, moment * (1.0 / 6)};
  }

  void add(const Moments& of, const int* voxel) {
    parts_.push_back({{voxel[0], voxel[1], voxel[2]}, of.area, of.moment});
  }

  /// Adds a polygon within a bar of voxels: what is in each is the difference of what is above its
  /// two sides.
  /// @param first  voxel
  void add_along(const Polygon<3>& bar, const IntervalRange& range, const int* first) {
    Moments now = moments_of(bar, range.first);
    int voxel[3] = {first[0], first[1], first[2]};
    Polygon<3> memory[2];
    const Polygon<3>* rest = &bar;
    for (int n = range.first; n < range.last; ++n, ++voxel[0]) {
      Polygon<3>& above = memory[n & 1];
      cut_polygon<0, 3>(*rest, n + 1, nullptr, above);
      const Moments next = above.has_area() ? moments_of(above, n + 1) : Moments{0, 0};
      add({now.area - next.area, now.moment - next.moment - next.area}, voxel);
      now = next;
      rest = &above;
      if (!above.has_area()) return;
    }
    add(now, voxel);
  }

  /// The parts along an axis of a polygon that lies within `ranges`.
  template <int axis, class Visit>
  static void along(const Polygon<3>& polygon,
                    const IntervalRange (&ranges)[3],
                    const Visit& visit) {
    if (ranges[axis].first == ranges[axis].last) return visit(ranges[axis].first, polygon);
    const IntervalRange range(polygon, axis);
    for_intervals<axis>(polygon, range, range.first, range.last + 1, visit);
  }

  std::vector<FacetPart> parts_;
};

}  // namespace tetwarp
