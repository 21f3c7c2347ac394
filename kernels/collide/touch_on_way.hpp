/// @file touch_on_way.hpp
/// Where two features touch that start near each other and are not hit during the motion.
#pragma once
#include <cstdint>

#include "kernels/collide/touch_maker.hpp"

namespace tetwarp {

/// A touch, which counts if its features are what is nearest of their surfaces.
struct TouchOnWay {
  PairTouch touch;
  double time = 0;
  double opening = 0;  ///< see TouchMaker
  bool is_from_behind = false;
};

TETWARP_ANY_EXEC inline TouchOnWay touch_at(const FeatureTouch& pair,
                                            double time,
                                            std::int32_t pass,
                                            const TouchView& view) {
  const FeatureTouch at{pair.pair, time > 0 ? time : 2, pair.start_distance};
  TouchMaker maker(at, pass, view);
  TouchOnWay result{maker.make(), time, maker.opening(), maker.is_from_behind()};
  result.touch.counts = maker.is_nearest();
  return result;
}

/// The touch at the start. Where its normal turns while the features pass each other, the touch at
/// the time at which they are nearest, since it is there that they would press: of two convex edges
/// that pass over each other, the normal of the start would stop the motion. That time is found by
/// regula falsi with Illinois weights (Dowell and Jarratt 1971). Where one side has come to the
/// other's back by then, through its surface beside this pair, the touch at the start remains.
TETWARP_ANY_EXEC inline TouchOnWay touch_on_way(const FeatureTouch& pair,
                                                std::int32_t pass,
                                                const TouchView& view) {
  constexpr int most_steps = 20;
  constexpr double same_time = 1e-3;  // of the time: the normal hardly differs
  const TouchOnWay first = touch_at(pair, 0, pass, view);
  const bool is_crossing = first.touch.is_inside || !first.touch.is_of_edges();
  if (first.touch.is_of_face() || !(first.touch.counts && is_crossing && first.opening < 0)) {
    return first;
  }
  TouchOnWay last = touch_at(pair, 1, pass, view);
  double low = 0, high = 1, opening_low = first.opening, opening_high = last.opening;
  for (int step = 0; step < most_steps && !last.touch.is_of_face(); ++step) {
    if (!(opening_high > 0) || high - low <= same_time * high) break;
    const double time = (low * opening_high - high * opening_low) / (opening_high - opening_low);
    const bool was_low = last.opening < 0;
    last = touch_at(pair, time, pass, view);
    const bool is_low = last.opening < 0;
    (is_low ? low : high) = time;
    (is_low ? opening_low : opening_high) = last.opening;
    if (step > 0 && is_low == was_low) (is_low ? opening_high : opening_low) /= 2;
  }
  return last.is_from_behind ? first : last;
}

}  // namespace tetwarp
