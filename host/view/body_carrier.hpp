/// @file body_carrier.hpp
/// BodyCarrier: moves a scripted body with the mouse.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/view/live_frame.hpp"

namespace tetwarp::view {

/// The body follows the mouse by at most some of its sizes a second, so that it pushes what is in
/// its way.
class BodyCarrier {
 public:
  /// @param simulator  at its start; kept by the caller
  explicit BodyCarrier(const Simulator& simulator);

  bool may_carry(std::size_t body) const;
  /// The body in the hand.
  std::optional<std::size_t> held() const {
    return held_ ? std::optional(held_->body) : std::nullopt;
  }
  /// @returns why it cannot be carried, or empty
  std::string take_up(std::size_t body, const Point3& point);
  /// @param point  where the point that was taken is to be [world]
  void pull(const Point3& point);
  void let_go() { held_.reset(); }
  /// To be called after the state of the simulator was replaced.
  void reset();
  /// From the start [m].
  const Point3& displacement(std::size_t body) const { return displacements_[body]; }

  struct Way {
    std::size_t body = 0;
    Point3 displacement{};  ///< from the start [m]
  };
  /// Where the body in the hand goes in the next step; nothing: it stays.
  std::optional<Way> next() const;
  void note(const Way& way) { displacements_[way.body] = way.displacement; }
  /// @param contacts  of the last step
  /// @param seconds   over which their impulses acted
  std::optional<GrabView> view(const std::vector<ContactPoint>& contacts, double seconds) const;

 private:
  struct Held {
    std::size_t body;
    Point3 start;   ///< where it was taken
    Point3 home;    ///< its displacement then
    Point3 target;  ///< the displacement to come to
  };

  Point3 first_point(std::size_t body) const;

  const Simulator& simulator_;
  std::vector<Point3> starts_;         ///< [bodies], of the first point of the surface
  std::vector<Point3> displacements_;  ///< [bodies], of scripted ones
  std::optional<Held> held_;
};

}  // namespace tetwarp::view
