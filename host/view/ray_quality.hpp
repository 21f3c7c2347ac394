/// @file ray_quality.hpp
/// RayQuality: how finely volumes are ray-cast, so that pictures follow the hand.
#pragma once
#include <cstddef>

namespace tetwarp::view {

struct RaySpacing {
  double step = 1;    ///< between samples of a ray [voxels]
  double pixels = 1;  ///< between rays

  bool operator==(const RaySpacing&) const = default;
};

/// Coarser when a picture takes longer than a fifteenth of a second, finer again when several in a
/// row took much less.
class RayQuality {
 public:
  /// @param is_software  without a graphics processor: starts coarsely
  explicit RayQuality(bool is_software = false);

  /// After each picture of things that move.
  void drew(double seconds);
  RaySpacing moving() const;
  /// Of a picture that nobody waits for: at most twice as coarse as the finest.
  RaySpacing resting() const;
  /// Whether the last pictures took so long that something else is better shown.
  bool gives_up() const;
  /// From now on it does not give up because of earlier pictures.
  void try_again() { slow_ = 0; }

 private:
  std::size_t level_;
  int quick_ = 0;  ///< pictures in a row that would have been in time more finely
  int slow_ = 0;   ///< that took far too long
};

}  // namespace tetwarp::view
