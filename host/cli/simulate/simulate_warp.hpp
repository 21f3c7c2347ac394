/// @file simulate_warp.hpp
/// Volumes that follow the bodies of a simulation.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/simulate/simulate_arguments.hpp"

namespace tetwarp::cli {

/// A volume as its body has deformed it.
struct WarpedBody {
  std::size_t body;
  const Volume* source;  ///< of the scene
  Volume volume;
};

/// Warps the volumes of bodies by the positions of their nodes: those of --warp are written to
/// NAME.warped_0000.vtkhdf and so on, --cast draws all. Positions are read in the memory of the
/// simulator, host or device.
class BodyWarps {
 public:
  /// Checks the options by preparing the first warp of each volume.
  /// @throws std::invalid_argument  naming the body, when none is made of a volume or an option
  ///                                does not suit its samples
  BodyWarps(const Simulator& simulator, const SimulateArguments& arguments);

  /// Warps the state of the simulator and writes it. @throws Cancelled after an interrupt
  void write_frame(std::int64_t frame);

  /// The volumes of the last frame; none without --cast.
  const std::vector<WarpedBody>& warped() const { return warped_; }
  /// Files written so far.
  const std::vector<std::string>& paths() const { return paths_; }
  double warp_seconds() const { return warp_seconds_; }
  double write_seconds() const { return write_seconds_; }

 private:
  /// A body made of a volume.
  struct Follower {
    std::size_t body;
    bool is_written;
    const Volume* source;  ///< of the scene
    Grid grid;             ///< of the last warp
    std::optional<Warper> warper;
  };

  /// Makes a Warper if the output grid for the positions of the body differs from that of the last
  /// one.
  void prepare(Follower& follower) const;
  WarpOptions options_of(const Follower& follower) const;
  /// Arrays of --outputs, zero.
  std::vector<Volume> extra_volumes(const Follower& follower) const;
  void write(const Follower& follower,
             const Volume& warped,
             const std::vector<Volume>& extra,
             std::int64_t frame);

  const Simulator& simulator_;
  const SimulateArguments& arguments_;
  std::vector<Follower> followers_;
  std::vector<WarpedBody> warped_;  ///< as followers_; with --cast
  std::vector<std::string> paths_;
  double warp_seconds_ = 0, write_seconds_ = 0;
};

}  // namespace tetwarp::cli
