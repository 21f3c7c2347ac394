/// @file volume_rays.hpp
/// VolumeRays: what rays see of volumes.
#pragma once
#include <array>
#include <span>
#include <vector>

#include <tetwarp/cast.hpp>

#include "host/base/index_space.hpp"
#include "host/make/clear_blocks.hpp"
#include "host/make/transfer.hpp"

namespace tetwarp {

/// What a ray has gathered.
struct RayColor {
  std::array<double, 3> color{};  ///< sRGB, weighted by what is seen of it
  double clear = 1;               ///< the part of what lies behind that is seen, 0 to 1
};

/// Volumes, prepared for rays.
class VolumeRays {
 public:
  /// @param volumes  must outlive this
  /// @throws std::invalid_argument  as cast_volumes()
  VolumeRays(std::span<const CastVolume> volumes, double step);

  /// The mean of rays that end at different depths.
  /// @param ray     what is at depth d lies at eye + d * ray [world]
  /// @param depths  above 0, or infinite; are sorted
  RayColor cast(const Point3& eye, const Point3& ray, std::span<double> depths) const;

 private:
  struct Entry {
    const Volume* volume;
    const TransferFunction* colors;
    IndexFromWorld index_from_world;
    ClearBlocks clear;
  };
  /// A volume along a ray.
  struct Passage {
    const Entry* entry;
    double enter, leave;     ///< depths
    Point3 origin, forward;  ///< of the ray in the index space of the volume
  };

  std::vector<Passage> passages_of(const Point3& eye, const Point3& ray) const;
  static Matter matter_at(const Passage& passage, double depth);
  /// Composites what lies between two depths.
  /// @param length  of a unit of depth [world]
  static void add_piece(const std::vector<Passage>& passages,
                        double from,
                        double to,
                        double length,
                        RayColor& gathered);

  std::vector<Entry> entries_;
  double step_ = 0;  ///< [world]
};

}  // namespace tetwarp
