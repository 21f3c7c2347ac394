/// @file rings.hpp
/// Rings of points, and the triangles between them.
#pragma once
#include <functional>
#include <vector>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// Rings of `around` points each. The surface is closed by a pole at either end, or the last ring
/// is joined to the first.
struct Rings {
  int around = 3;
  std::vector<std::function<Point3(double angle)>> ring;
  bool is_loop = false;
  Point3 first_pole{0, 0, 0}, last_pole{0, 0, 0};
};

/// Outwards, if angles turn right-handed about the direction in which the rings follow each other.
Surface ring_surface(const Rings& rings);

double triangle_count(const Rings& rings);

}  // namespace tetwarp
