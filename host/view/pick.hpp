/// @file pick.hpp
/// The first triangle that a ray meets.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp::view {

/// A half-line from an eye or a wand.
struct EyeRay {
  Point3 origin{}, direction{};

  bool operator==(const EyeRay&) const = default;
};

/// A point of a surface.
struct Pick {
  std::size_t body = 0;
  Point3 point{};
  double distance = 0;  ///< along the ray, in lengths of its direction
};

/// A plane that hides what is on the side of its normal.
struct Cut {
  Point3 point{}, normal{0, 0, 1};

  bool operator==(const Cut&) const = default;
};

using Triangles = std::vector<std::array<std::int32_t, 3>>;

/// Where a ray meets the surfaces of bodies first; either side of a triangle counts, what is cut
/// away does not.
/// @param points     [bodies] of the surfaces, world
/// @param triangles  [bodies]
std::optional<Pick> pick(const std::vector<std::vector<Point3>>& points,
                         const std::vector<Triangles>& triangles,
                         const Point3& origin,
                         const Point3& direction,
                         const std::optional<Cut>& cut = {});

}  // namespace tetwarp::view
