/// @file following_motion.hpp
/// FollowingMotion: velocities that are accelerated together with impulses, by conjugate
/// directions.
#pragma once
#include <cstdint>
#include <vector>

#include "kernels/contact/contact_accelerators.hpp"

namespace tetwarp {

/// Numbers that depend linearly on the vector x of a ConjugateDirection. They are updated by the
/// same steps as x, which costs less than computing them from x.
class FollowingMotion {
 public:
  /// Restarts. @param places  of the numbers, in the vectors of the other functions
  void start(const std::vector<std::int64_t>& places) {
    places_ = places;
    before_.resize(places_.size());
    direction_.assign(places_.size(), 0.0);
  }
  /// Copies the numbers at x.
  void keep(const double* motion) {
    for (std::size_t k = 0; k < places_.size(); ++k) before_[k] = motion[places_[k]];
  }
  /// Replaces the numbers at the image, after ConjugateDirection::advance() has replaced the image.
  void advance(bool is_restart, double ratio, double* motion) {
    for (std::size_t k = 0; k < places_.size(); ++k) {
      double& own = motion[places_[k]];
      const double defect = own - before_[k], step = is_restart ? 0 : ratio * direction_[k];
      own += step;
      direction_[k] = is_restart ? 0 : step + defect;
    }
  }

 private:
  std::vector<std::int64_t> places_;
  std::vector<double> before_, direction_;
};

}  // namespace tetwarp
