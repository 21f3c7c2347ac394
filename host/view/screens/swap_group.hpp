/// @file swap_group.hpp
/// SwapGroup: which screens draw a frame, and when they show it.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetwarp::view {

/// The bookkeeping of the swap barrier, without clock and sockets. Members are known by the address
/// of their process; times are seconds that do not fall. A frame goes to all members that are not
/// busy. They show it together: when all have drawn it, or when `wait` is over; a late member
/// shows it when it is ready, and gets the newest frame then.
class SwapGroup {
 public:
  using Member = std::string;

  /// @param wait    longest time from a frame to its swap [s]
  /// @param silent  a member that was not heard of for so long is lost [s]; 15 times as long while
  ///                it draws
  SwapGroup(double wait, double silent) : wait_(wait), silent_(silent) {}

  /// A process shows a screen from now on. @returns another one that showed it, or empty
  Member join(const Member& member, const std::string& screen, double now);
  /// @returns whether it was a member
  bool leave(const Member& member);
  /// @returns whether it is a member
  bool hear(const Member& member, double now);
  /// Removes members that are lost. @returns the screens that they showed
  std::vector<std::string> drop_silent(double now);

  bool is_drawing() const { return is_drawing_; }
  /// Begins a frame, unless all members are busy. @returns the members to send it to
  std::vector<Member> begin_frame(std::uint64_t frame, double now);
  /// A member has drawn a frame. @returns whether it is to show it at once, as it is late
  bool ready(const Member& member, std::uint64_t frame, double now);
  /// Whether the frame is to be shown now.
  bool may_swap(double now) const;
  /// Ends the frame. @returns the members that show it now
  std::vector<Member> swap();
  /// When may_swap() becomes true by itself [s]; only while is_drawing().
  double latest_swap() const { return begun_ + wait_; }

  /// The frames that late members draw.
  std::map<Member, std::uint64_t> late_frames() const;
  std::vector<Member> members() const;
  std::size_t size() const { return members_.size(); }
  /// Members that were not ready in time, counted once for each frame.
  std::int64_t late_count() const { return late_count_; }

 private:
  enum class Doing { idle, drawing, drawn, late };
  struct State {
    std::string screen;
    double heard = 0;
    Doing doing = Doing::idle;
    std::uint64_t frame = 0;
  };

  double wait_, silent_, begun_ = 0;
  bool is_drawing_ = false;
  std::uint64_t frame_ = 0;
  std::int64_t late_count_ = 0;
  std::map<Member, State> members_;
};

}  // namespace tetwarp::view
