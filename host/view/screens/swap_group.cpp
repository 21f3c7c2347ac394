/// @file swap_group.cpp
/// Members come, draw, fall behind and go.
#include "host/view/screens/swap_group.hpp"

#include <algorithm>

namespace tetwarp::view {
namespace {
/// A process draws and speaks in one thread, so it is silent while it draws, and the first picture
/// of a large volume takes seconds without a graphics card.
constexpr double busy_patience = 15;  // times the longest silence of an idle member
}  // namespace

SwapGroup::Member SwapGroup::join(const Member& member, const std::string& screen, double now) {
  Member before;
  for (const auto& [other, state] : members_) {
    if (state.screen == screen && other != member) before = other;
  }
  members_.erase(before);
  members_[member] = {screen, now, Doing::idle, 0};
  return before;
}

bool SwapGroup::leave(const Member& member) {
  return members_.erase(member) > 0;
}

bool SwapGroup::hear(const Member& member, double now) {
  const auto found = members_.find(member);
  if (found == members_.end()) return false;
  found->second.heard = now;
  return true;
}

std::vector<std::string> SwapGroup::drop_silent(double now) {
  std::vector<std::string> screens;
  std::erase_if(members_, [&](const auto& entry) {
    const State& state = entry.second;
    const bool is_busy = state.doing == Doing::drawing || state.doing == Doing::late;
    const bool is_lost = now - state.heard > (is_busy ? busy_patience * silent_ : silent_);
    if (is_lost) screens.push_back(state.screen);
    return is_lost;
  });
  return screens;
}

std::vector<SwapGroup::Member> SwapGroup::begin_frame(std::uint64_t frame, double now) {
  std::vector<Member> all;
  for (auto& [member, state] : members_) {
    if (state.doing != Doing::idle) continue;
    state.doing = Doing::drawing;
    state.frame = frame;
    all.push_back(member);
  }
  is_drawing_ = !all.empty();
  frame_ = frame;
  begun_ = now;
  return all;
}

bool SwapGroup::ready(const Member& member, std::uint64_t frame, double now) {
  if (!hear(member, now)) return false;
  State& state = members_[member];
  if (state.frame != frame) return false;
  const bool is_late = state.doing == Doing::late;
  if (is_late) state.doing = Doing::idle;
  if (state.doing == Doing::drawing) state.doing = Doing::drawn;
  return is_late;
}

bool SwapGroup::may_swap(double now) const {
  if (!is_drawing_) return false;
  const bool is_waiting = std::ranges::any_of(
      members_, [](const auto& entry) { return entry.second.doing == Doing::drawing; });
  return !is_waiting || now >= latest_swap();
}

std::vector<SwapGroup::Member> SwapGroup::swap() {
  std::vector<Member> all;
  for (auto& [member, state] : members_) {
    if (state.doing == Doing::drawn) {
      state.doing = Doing::idle;
      all.push_back(member);
    } else if (state.doing == Doing::drawing) {
      state.doing = Doing::late;
      ++late_count_;
    }
  }
  is_drawing_ = false;
  return all;
}

std::map<SwapGroup::Member, std::uint64_t> SwapGroup::late_frames() const {
  std::map<Member, std::uint64_t> frames;
  for (const auto& [member, state] : members_) {
    if (state.doing == Doing::late) frames[member] = state.frame;
  }
  return frames;
}

std::vector<SwapGroup::Member> SwapGroup::members() const {
  std::vector<Member> all;
  for (const auto& [member, state] : members_) all.push_back(member);
  return all;
}

}  // namespace tetwarp::view
