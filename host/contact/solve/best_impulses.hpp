/// @file best_impulses.hpp
/// The impulses of an island with the smallest error so far.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace tetwarp {

/// Starts with the impulses at construction.
class BestImpulses {
 public:
  /// @param impulse  current impulses, kept by the caller
  /// @param excess   their error over the allowed error
  BestImpulses(double* impulse, std::int64_t size, double excess)
      : impulse_(impulse), best_(impulse, impulse + size), excess_(excess) {}

  void keep(const double* impulse, double excess) {
    if (!(excess < excess_)) return;
    excess_ = excess;
    std::copy_n(impulse, best_.size(), best_.begin());
  }
  double excess() const { return excess_; }
  /// Makes the best impulses the current ones.
  void restore() { std::copy(best_.begin(), best_.end(), impulse_); }

 private:
  double* impulse_;
  std::vector<double> best_;
  double excess_;
};

}  // namespace tetwarp
