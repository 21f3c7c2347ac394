/// @file added_seconds.hpp
/// AddedSeconds: adds the seconds of a scope to a sum.
#pragma once
#include "host/base/stopwatch.hpp"

namespace tetwarp {

class AddedSeconds {
 public:
  /// @param sum  gets the seconds from here to the end of the object's life
  explicit AddedSeconds(double& sum) : sum_(sum) {}
  AddedSeconds(const AddedSeconds&) = delete;
  AddedSeconds& operator=(const AddedSeconds&) = delete;
  ~AddedSeconds() { sum_ += stopwatch_.seconds(); }

 private:
  double& sum_;
  Stopwatch stopwatch_;
};

}  // namespace tetwarp
