/// @file phantom_shapes.hpp
/// The solids of a phantom. Lengths in mm; x points to the left of the body, y to its back, z to
/// its head.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <variant>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Share of a voxel that a solid fills, by the distance of its surface from the voxel's center;
/// negative inside.
inline double coverage(double distance, double voxel) {
  return std::clamp(0.5 - distance / voxel, 0.0, 1.0);
}

/// Axis-parallel box around a solid.
struct Extent {
  Point3 low;
  Point3 high;
};

/// An ellipsoid, tilted in the plane of x and z.
class Ellipsoid {
 public:
  /// @param radii  along the tilted x, along y, along the tilted z
  /// @param lean   tilt [radian]; positive: the top moves towards positive x
  Ellipsoid(const Point3& center, const Point3& radii, double lean = 0)
      : center_(center),
        radii_(radii),
        reciprocal_{1 / radii[0], 1 / radii[1], 1 / radii[2]},
        cosine_(std::cos(lean)),
        sine_(std::sin(lean)) {}

  /// Distance to the surface to first order, (k - 1) / |gradient of k| with k = 1 on the surface;
  /// negative inside.
  double distance(double x, double y, double z) const {
    const double dx = x - center_[0];
    const double dz = z - center_[2];
    const double a = (cosine_ * dx - sine_ * dz) * reciprocal_[0];
    const double b = (y - center_[1]) * reciprocal_[1];
    const double c = (sine_ * dx + cosine_ * dz) * reciprocal_[2];
    const double k = std::sqrt(a * a + b * b + c * c);
    const double ga = a * reciprocal_[0];
    const double gb = b * reciprocal_[1];
    const double gc = c * reciprocal_[2];
    // The lower bounds avoid 0 / 0 at the center, where any negative distance will do.
    return (k - 1) * std::max(k, 1e-6) / std::max(std::sqrt(ga * ga + gb * gb + gc * gc), 1e-9);
  }

  Extent extent() const {
    const double rx = std::hypot(cosine_ * radii_[0], sine_ * radii_[2]);
    const double rz = std::hypot(sine_ * radii_[0], cosine_ * radii_[2]);
    return {{center_[0] - rx, center_[1] - radii_[1], center_[2] - rz},
            {center_[0] + rx, center_[1] + radii_[1], center_[2] + rz}};
  }

 private:
  Point3 center_;
  Point3 radii_;
  Point3 reciprocal_;  // of the radii, computed once for speed
  double cosine_;
  double sine_;
};

/// A rod with round ends whose radius changes linearly from one end to the other.
struct Rod {
  Point3 from;
  Point3 to;
  double from_radius;
  double to_radius;

  double distance(double x, double y, double z) const {
    const Point3 d{to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const Point3 p{x - from[0], y - from[1], z - from[2]};
    const double along = (p[0] * d[0] + p[1] * d[1] + p[2] * d[2]) /
                         std::max(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1e-9);
    const double t = std::clamp(along, 0.0, 1.0);
    const Point3 q{p[0] - t * d[0], p[1] - t * d[1], p[2] - t * d[2]};
    return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) -
           (from_radius + t * (to_radius - from_radius));
  }

  Extent extent() const {
    const double radius = std::max(from_radius, to_radius);
    Extent box;
    for (std::size_t d = 0; d < 3; ++d) {
      box.low[d] = std::min(from[d], to[d]) - radius;
      box.high[d] = std::max(from[d], to[d]) + radius;
    }
    return box;
  }
};

struct Organ {
  std::variant<Ellipsoid, Rod> solid;
  double level;
};

/// A body: outline and organs.
struct Anatomy {
  std::vector<Ellipsoid> trunk;  ///< blended smoothly into one another
  std::vector<Organ> organs;     ///< drawn in this order, each over the ones before
};

/// Size of the box that the anatomy is made for, centered at the origin [mm].
constexpr Point3 anatomy_size{384, 240, 366};

}  // namespace tetwarp
