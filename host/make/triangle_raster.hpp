/// @file triangle_raster.hpp
/// Depth buffers: which triangle is nearest at each sample of a picture or of a shadow map.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <tetwarp/volume.hpp>

#include "host/base/parallel.hpp"

namespace tetwarp {

/// A point of the picture plane: x to the right and y downwards [sample], and a nearness that is
/// linear over the picture plane and larger for what is nearer.
struct PicturePoint {
  double x = 0, y = 0;
  double nearness = 0;
  bool is_visible = true;  ///< false: triangles with this point are left out
};

/// The nearest triangle at each sample; rows from top to bottom.
struct DepthBuffer {
  int width = 0, height = 0;
  std::vector<float> nearness;         ///< -infinity where there is no triangle
  std::vector<std::int32_t> triangle;  ///< -1 where there is none

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// Weights of the corners of a triangle at a sample; false outside.
inline bool corner_weights(const std::array<PicturePoint, 3>& corners,
                           double x,
                           double y,
                           std::array<double, 3>& weights) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const PicturePoint& a = corners[(c + 1) % 3];
    const PicturePoint& b = corners[(c + 2) % 3];
    weights[c] = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    sum += weights[c];
  }
  if (!(sum != 0)) return false;
  for (double& weight : weights) weight /= sum;
  return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
}

/// Draws the rows [first, last) of one triangle. @pre its corners are visible
inline void draw_triangle(const std::array<PicturePoint, 3>& corners,
                          std::int32_t triangle,
                          int first,
                          int last,
                          DepthBuffer& buffer) {
  double low[2] = {corners[0].x, corners[0].y}, high[2] = {low[0], low[1]};
  for (const PicturePoint& corner : corners) {
    low[0] = std::min(low[0], corner.x);
    high[0] = std::max(high[0], corner.x);
    low[1] = std::min(low[1], corner.y);
    high[1] = std::max(high[1], corner.y);
  }
  const auto sample = [](double value, int begin, int end) {
    return static_cast<int>(std::clamp<double>(value, begin, end));
  };
  const int top = sample(std::ceil(low[1] - 0.5), first, last);
  const int bottom = sample(std::floor(high[1] - 0.5) + 1, first, last);
  const int left = sample(std::ceil(low[0] - 0.5), 0, buffer.width);
  const int right = sample(std::floor(high[0] - 0.5) + 1, 0, buffer.width);
  std::array<double, 3> weights{};
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      if (!corner_weights(corners, x + 0.5, y + 0.5, weights)) continue;
      const auto nearness =
          static_cast<float>(weights[0] * corners[0].nearness + weights[1] * corners[1].nearness +
                             weights[2] * corners[2].nearness);
      const std::size_t at = buffer.at(x, y);
      if (!(nearness > buffer.nearness[at])) continue;
      buffer.nearness[at] = nearness;
      buffer.triangle[at] = triangle;
    }
  }
}

/// Triangles that reach into each band of rows, ascending: first entry of each band, then the
/// triangles.
struct BandTriangles {
  static constexpr int rows = 32;  ///< of a band
  std::vector<std::size_t> first;
  std::vector<std::int32_t> triangle;
};

inline BandTriangles triangles_of_bands(const std::vector<PicturePoint>& points,
                                        const std::vector<std::array<std::int32_t, 3>>& triangles,
                                        int height) {
  const int band_count = (height + BandTriangles::rows - 1) / BandTriangles::rows;
  BandTriangles bands;
  bands.first.assign(static_cast<std::size_t>(band_count) + 1, 0);
  const auto for_each_entry = [&](const auto& visit) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const PicturePoint& a = points[static_cast<std::size_t>(triangles[t][0])];
      const PicturePoint& b = points[static_cast<std::size_t>(triangles[t][1])];
      const PicturePoint& c = points[static_cast<std::size_t>(triangles[t][2])];
      if (!a.is_visible || !b.is_visible || !c.is_visible) continue;
      const double low = std::min({a.y, b.y, c.y}), high = std::max({a.y, b.y, c.y});
      if (!(high >= 0) || !(low < height)) continue;
      const int last = std::min(
          band_count - 1, static_cast<int>(std::min<double>(high, height)) / BandTriangles::rows);
      for (int band = static_cast<int>(std::max(low, 0.0)) / BandTriangles::rows; band <= last;
           ++band) {
        visit(static_cast<std::size_t>(band), static_cast<std::int32_t>(t));
      }
    }
  };
  for_each_entry([&](std::size_t band, std::int32_t) { ++bands.first[band + 1]; });
  for (std::size_t b = 0; b + 1 < bands.first.size(); ++b) bands.first[b + 1] += bands.first[b];
  bands.triangle.resize(bands.first.back());
  std::vector<std::size_t> next(bands.first.begin(), bands.first.end() - 1);
  for_each_entry([&](std::size_t band, std::int32_t t) { bands.triangle[next[band]++] = t; });
  return bands;
}

/// Draws all triangles. Of equally near ones the first is kept.
inline DepthBuffer draw_triangles(const std::vector<PicturePoint>& points,
                                  const std::vector<std::array<std::int32_t, 3>>& triangles,
                                  int width,
                                  int height) {
  DepthBuffer buffer{width, height, {}, {}};
  const auto samples = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  buffer.nearness.assign(samples, -INFINITY);
  buffer.triangle.assign(samples, -1);
  const BandTriangles bands = triangles_of_bands(points, triangles, height);
  parallel_tasks(thread_count(0), std::ssize(bands.first) - 1, [&](std::int64_t band) {
    const int first = static_cast<int>(band) * BandTriangles::rows;
    const int last = std::min(first + BandTriangles::rows, height);
    const auto at = static_cast<std::size_t>(band);
    for (std::size_t n = bands.first[at]; n < bands.first[at + 1]; ++n) {
      const std::int32_t t = bands.triangle[n];
      std::array<PicturePoint, 3> corners;
      for (std::size_t c = 0; c < 3; ++c) {
        corners[c] = points[static_cast<std::size_t>(triangles[static_cast<std::size_t>(t)][c])];
      }
      draw_triangle(corners, t, first, last, buffer);
    }
  });
  return buffer;
}

}  // namespace tetwarp
