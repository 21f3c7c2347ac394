/// @file live_volumes.hpp
/// LiveVolumes: the volumes of bodies, warped to where their nodes are.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <tetwarp/simulate.hpp>
#include <tetwarp/warp.hpp>

#include "host/view/live_frame.hpp"
#include "host/view/view_options.hpp"

namespace tetwarp::view {

/// A body made of a volume, and the range of its values.
struct VolumeBody {
  std::size_t body = 0;
  double low = 0, high = 1;
};

class LiveVolumes {
 public:
  /// @param simulator  kept by the caller
  LiveVolumes(const Simulator& simulator, const ViewOptions& options);

  const std::vector<VolumeBody>& bodies() const { return bodies_; }
  /// Warps all volumes to the state of the simulator.
  void warp(std::vector<VolumeFrame>& frames);

 private:
  struct Follower {
    Volume source;  ///< one int16 per voxel
    bool holds_labels = false;
    std::optional<Warper> warper;
    Grid grid;
  };
  void place(std::size_t volume, const std::vector<Point3>& nodes);

  const Simulator& simulator_;
  std::int64_t most_voxels_;  ///< of each volume
  int device_, threads_;
  std::vector<VolumeBody> bodies_;
  std::vector<Follower> followers_;  ///< [bodies_]
};

/// A grid along the world's axes around points, with a margin of a tenth of their box on all sides.
/// @param least_spacing  [m]
/// @param most_voxels    about
Grid grid_around(const std::vector<Point3>& points, double least_spacing, std::int64_t most_voxels);

}  // namespace tetwarp::view
