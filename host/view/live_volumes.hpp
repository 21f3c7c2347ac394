/// @file live_volumes.hpp
/// LiveVolumes: the volumes of bodies, warped to where their nodes are.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
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

/// The volume of a body at rest.
struct RestVolume {
  VolumeBody body;
  Volume volume;  ///< one int16 per voxel
  bool holds_labels = false;
};

/// The mesh that warps a volume, and where its nodes are.
struct VolumeNodes {
  const Mesh* mesh = nullptr;
  std::vector<Point3> places;  ///< on the host
  PositionsView view;          ///< the same, for the warp
};

class LiveVolumes {
 public:
  /// @param options  voxels, device and threads
  LiveVolumes(std::vector<RestVolume> sources, const ViewOptions& options, Backend backend);

  const std::vector<RestVolume>& sources() const { return sources_; }
  /// Warps all volumes to where the nodes of their bodies are.
  /// @param nodes_of  of a volume; called once for each
  void warp(const std::function<VolumeNodes(std::size_t volume)>& nodes_of,
            std::vector<VolumeFrame>& frames);

 private:
  struct Follower {
    std::optional<Warper> warper;
    Grid grid;
  };
  void place(std::size_t volume, const VolumeNodes& nodes);

  std::vector<RestVolume> sources_;
  std::vector<Follower> followers_;  ///< [sources_]
  std::int64_t most_voxels_;         ///< of each volume
  int device_, threads_;
  Backend backend_;
};

/// The volumes of all bodies that are made of one and have a mesh.
std::vector<RestVolume> rest_volumes(const Simulator& simulator);

/// The value of the voxel at a point; nothing outside of the volume.
std::optional<double> value_at(const VolumeFrame& frame, const VolumeBody& range, const Point3& x);

/// A grid along the world's axes around points, with a margin of a tenth of their box on all sides.
/// @param least_spacing  [m]
/// @param most_voxels    about
Grid grid_around(const std::vector<Point3>& points, double least_spacing, std::int64_t most_voxels);

}  // namespace tetwarp::view
