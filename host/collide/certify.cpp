/// @file certify.cpp
/// Finds the pairs of triangles whose motions have overlapping boxes, and judges each.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <tetwarp/certify.hpp>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/collide/moving_triangles.hpp"

namespace tetwarp {
namespace {
/// A triangle and the box of its motion, which holds it at all times.
struct SweptTriangle {
  std::int32_t surface, triangle;
  Bounds box;
};

void check_points(const std::vector<Point3>& points, const std::string& name) {
  constexpr double largest = 1e150;
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (const double x : points[p]) {
      if (!(std::abs(x) <= largest)) {
        throw std::invalid_argument(name + ": point " + std::to_string(p) +
                                    " has a coordinate that is not finite or above 1e150");
      }
    }
  }
}

void check_moving_surface(const MovingSurface& surface, std::size_t number) {
  const std::string name = "surface " + std::to_string(number);
  if (surface.start.size() != surface.end.size()) {
    throw std::invalid_argument(name + ": expected as many points at the end as at the start, " +
                                std::to_string(surface.start.size()) + ", got " +
                                std::to_string(surface.end.size()));
  }
  check_points(surface.start, name + " at the start");
  check_points(surface.end, name + " at the end");
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const std::int32_t point : surface.triangles[t]) {
      if (point < 0 || point >= std::ssize(surface.start)) {
        throw std::invalid_argument(name + ": triangle " + std::to_string(t) +
                                    " has a point beyond the " +
                                    std::to_string(surface.start.size()) + " of the surface");
      }
    }
  }
}

std::vector<SweptTriangle> swept_triangles(std::span<const MovingSurface> surfaces) {
  std::vector<SweptTriangle> all;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for (std::size_t t = 0; t < surfaces[s].triangles.size(); ++t) {
      SweptTriangle swept{static_cast<std::int32_t>(s), static_cast<std::int32_t>(t), {}};
      for (const std::int32_t point : surfaces[s].triangles[t]) {
        swept.box.include(surfaces[s].start[static_cast<std::size_t>(point)]);
        swept.box.include(surfaces[s].end[static_cast<std::size_t>(point)]);
      }
      all.push_back(swept);
    }
  }
  return all;
}

/// The axis along which the centers of boxes vary most.
std::size_t widest_axis(const std::vector<SweptTriangle>& swept) {
  Point3 sum{0, 0, 0}, squares{0, 0, 0};
  for (const SweptTriangle& one : swept) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double center = 0.5 * one.box.low[axis] + 0.5 * one.box.high[axis];
      sum[axis] += center;
      squares[axis] += center * center;
    }
  }
  std::size_t widest = 0;
  const auto spread = [&](std::size_t axis) {
    return squares[axis] - sum[axis] * (sum[axis] / static_cast<double>(swept.size()));
  };
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (spread(axis) > spread(widest)) widest = axis;
  }
  return widest;
}

bool boxes_overlap(const Bounds& a, const Bounds& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (a.low[axis] > b.high[axis] || b.low[axis] > a.high[axis]) return false;
  }
  return true;
}

/// Whether two triangles of one surface have a point of it in common.
bool share_point(const std::array<std::int32_t, 3>& a, const std::array<std::int32_t, 3>& b) {
  return std::ranges::any_of(
      a, [&](std::int32_t point) { return std::ranges::find(b, point) != b.end(); });
}

TrianglePairMotion motion_of(std::span<const MovingSurface> surfaces, const CertifiedPair& pair) {
  TrianglePairMotion motion;
  for (std::size_t side = 0; side < 2; ++side) {
    const MovingSurface& surface = surfaces[static_cast<std::size_t>(pair.surfaces[side])];
    const auto& triangle = surface.triangles[static_cast<std::size_t>(pair.triangles[side])];
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto point = static_cast<std::size_t>(triangle[corner]);
      motion.start[3 * side + corner] = surface.start[point];
      motion.end[3 * side + corner] = surface.end[point];
    }
  }
  return motion;
}

double fraction_of(std::int64_t time) {
  return std::ldexp(static_cast<double>(time), -time_bits);
}

/// Judges the pairs of one triangle with those behind it in the sorted list.
Certificate certify_one(std::span<const MovingSurface> surfaces,
                        const std::vector<SweptTriangle>& swept,
                        std::size_t first,
                        std::size_t axis,
                        const CertifyOptions& options) {
  Certificate found;
  const SweptTriangle& one = swept[first];
  for (std::size_t k = first + 1; k < swept.size(); ++k) {
    const SweptTriangle& other = swept[k];
    if (other.box.low[axis] > one.box.high[axis]) break;
    if (!boxes_overlap(one.box, other.box)) continue;
    CertifiedPair pair{{one.surface, other.surface}, {one.triangle, other.triangle}};
    if (one.surface == other.surface) {
      const auto& triangles = surfaces[static_cast<std::size_t>(one.surface)].triangles;
      if (!options.self || share_point(triangles[static_cast<std::size_t>(one.triangle)],
                                       triangles[static_cast<std::size_t>(other.triangle)])) {
        continue;
      }
    }
    if (std::pair(other.surface, other.triangle) < std::pair(one.surface, one.triangle)) {
      std::swap(pair.surfaces[0], pair.surfaces[1]);
      std::swap(pair.triangles[0], pair.triangles[1]);
    }
    ++found.near_pairs;
    const PairVerdict verdict = judge(motion_of(surfaces, pair), options.most_intervals);
    found.intervals += verdict.intervals;
    if (verdict.verdict == Verdict::free) continue;
    pair.verdict = verdict.verdict;
    pair.from = fraction_of(verdict.from);
    pair.until = fraction_of(verdict.until);
    found.pairs.push_back(pair);
  }
  return found;
}
}  // namespace

Certificate certify(std::span<const MovingSurface> surfaces, const CertifyOptions& options) {
  const int threads = thread_count(options.threads);
  if (options.most_intervals < 1) {
    throw std::invalid_argument("most_intervals: expected 1 or more, got " +
                                std::to_string(options.most_intervals));
  }
  for (std::size_t s = 0; s < surfaces.size(); ++s) check_moving_surface(surfaces[s], s);
  std::vector<SweptTriangle> swept = swept_triangles(surfaces);
  const std::size_t axis = widest_axis(swept);
  std::ranges::stable_sort(swept, {}, [&](const SweptTriangle& one) { return one.box.low[axis]; });
  std::vector<Certificate> parts(swept.size());
  parallel_for(threads, std::ssize(swept), [&](std::int64_t t) {
    const auto first = static_cast<std::size_t>(t);
    parts[first] = certify_one(surfaces, swept, first, axis, options);
  });
  Certificate all;
  for (const Certificate& part : parts) {
    all.pairs.insert(all.pairs.end(), part.pairs.begin(), part.pairs.end());
    all.near_pairs += part.near_pairs;
    all.intervals += part.intervals;
  }
  std::ranges::sort(all.pairs);
  for (const CertifiedPair& pair : all.pairs) {
    if (pair.verdict == Verdict::meets || all.verdict == Verdict::free) all.verdict = pair.verdict;
  }
  return all;
}

}  // namespace tetwarp
