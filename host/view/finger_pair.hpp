/// @file finger_pair.hpp
/// FingerPair: the spring of the skin between two fingers of which the mouse carries one.
#pragma once
#include <cstddef>
#include <optional>

#include <tetwarp/simulate.hpp>

#include "host/view/body_carrier.hpp"
#include "host/view/live_frame.hpp"
#include "host/view/view_options.hpp"

namespace tetwarp::view {

/// The outer finger is before the skin and goes where the mouse takes it; the inner one is behind
/// it, touches what is there and feels it. The skin keeps it where it was seen from the outer one.
class FingerPair {
 public:
  /// Adds the spring, if the scene has the bodies of ViewOptions::fingers.
  /// @param simulator  at its start; kept by the caller
  FingerPair(Simulator& simulator, const ViewOptions& options);

  /// A scripted body is moved.
  /// @param displacement  from its start [m]
  void follow(std::size_t body, const Point3& displacement);
  /// To be called after the state of the simulator was replaced.
  /// @param carrier  after its own reset()
  void reset(const BodyCarrier& carrier);
  /// The inner finger, where the skin holds it, and the force of the skin on it.
  /// @param carried  the body that the mouse carries
  /// @returns nothing where there are no fingers, or another body is carried
  std::optional<GrabView> view(const StepRecord& record,
                               const std::optional<std::size_t>& carried) const;

 private:
  Simulator& simulator_;
  std::optional<std::size_t> outer_, inner_;  ///< bodies
  Point3 start_{};                            ///< center of the inner finger
  Point3 displacement_{};                     ///< of the outer finger
};

}  // namespace tetwarp::view
