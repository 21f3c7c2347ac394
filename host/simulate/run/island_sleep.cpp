#include "host/simulate/run/island_sleep.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/number_hash.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();

void add_to(NumberHash& hash, const Point3& x) {
  for (const double number : x) hash.add(number + 0.0);  // -0 as 0
}

std::int32_t root_of(std::vector<std::int32_t>& parent, std::size_t island) {
  auto i = static_cast<std::int32_t>(island);
  while (parent[index_of(i)] != i) {
    parent[index_of(i)] = parent[index_of(parent[index_of(i)])];
    i = parent[index_of(i)];
  }
  return i;
}

}  // namespace

std::int32_t IslandSleep::island_of(std::int32_t body) const {
  return index_of(body) < model_.body_island.size() ? model_.body_island[index_of(body)] : -1;
}

bool IslandSleep::is_asleep(std::int32_t body) const {
  const std::int32_t island = island_of(body);
  return is_on_ && island >= 0 && now_.is_asleep[index_of(island)] != 0;
}

bool IslandSleep::any_asleep() const {
  return std::find(now_.is_asleep.begin(), now_.is_asleep.end(), 1) != now_.is_asleep.end();
}

void IslandSleep::interrupt() {
  std::fill(now_.calm_time.begin(), now_.calm_time.end(), 0);
}

/// Whether a prescribed block moves by more than the rounding of its place.
bool IslandSleep::moves(std::int32_t block, const ModelState& state, const StepInput& input) const {
  const auto k = index_of(block);
  const double way = norm(input.prescribed_velocity[k]) * input.time_step;
  if (way == 0) return false;
  const std::int64_t past = std::int64_t{block} - model_.node_count;
  if (past >= 0 && past % 2 == 1) return way > rounding;
  const Point3& place = state.position[past < 0 ? k : index_of(model_.node_count + past / 2)];
  const std::int32_t body = block_body_[k];
  return way > rounding * (norm(place) + (body < 0 ? 0 : body_size_[index_of(body)]));
}

void IslandSleep::note_what_moves(const ModelState& state, const StepInput& input) {
  for (std::size_t b = 0; b < body_driven_.size(); ++b) {
    is_driven_[b] = std::any_of(body_driven_[b].begin(), body_driven_[b].end(),
                                [&](std::int32_t block) { return moves(block, state, input); });
  }
}

std::uint64_t IslandSleep::hash_of(const Island& island, const StepInput& input) const {
  NumberHash hash;
  for (const std::int32_t block : island.blocks) add_to(hash, input.block_force[index_of(block)]);
  for (const std::int32_t s : island.springs) {
    hash.add(input.is_active[index_of(s)] != 0 ? 1.0 : 0.0);
    if (input.is_active[index_of(s)] != 0) add_to(hash, input.anchor[index_of(s)]);
  }
  return hash.value();
}

void IslandSleep::set_still() {
  still_.clear();
  if (!any_asleep()) return;
  still_.resize(body_driven_.size());
  for (std::size_t b = 0; b < still_.size(); ++b) {
    const auto body = static_cast<std::int32_t>(b);
    still_[b] = island_of(body) >= 0 ? is_asleep(body) : is_driven_[b] == 0;
  }
}

void IslandSleep::fill(StepInput& input) const {
  input.is_asleep.clear();
  if (still_.empty()) return;
  input.is_asleep.assign(block_body_.size(), 0);
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    if (now_.is_asleep[i] == 0) continue;
    for (const std::int32_t block : islands_[i].blocks) input.is_asleep[index_of(block)] = 1;
    for (const std::int32_t block : islands_[i].driven) {
      input.prescribed_velocity[index_of(block)] = {0, 0, 0};
    }
  }
}

bool IslandSleep::begin(const ModelState& state,
                        std::span<const BodyLink> links,
                        StepInput& input) {
  if (!is_on_) return false;
  note_what_moves(state, input);
  std::vector<std::int32_t> woken;
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    const Island& island = islands_[i];
    if (now_.is_asleep[i] == 0) continue;
    const bool is_pulled =
        std::any_of(island.driven.begin(), island.driven.end(),
                    [&](std::int32_t block) { return moves(block, state, input); });
    if (is_pulled || hash_of(island, input) != now_.inputs[i]) woken.push_back(island.bodies[0]);
  }
  for (const auto& [a, b] : links) {
    if (is_driven_[index_of(a)] != 0 && is_asleep(b)) woken.push_back(b);
    if (is_driven_[index_of(b)] != 0 && is_asleep(a)) woken.push_back(a);
  }
  wake(woken, links, input);
  return !woken.empty();
}

void IslandSleep::wake(std::span<const std::int32_t> bodies,
                       std::span<const BodyLink> links,
                       StepInput& input) {
  std::vector<std::int32_t> next(bodies.begin(), bodies.end());
  while (!next.empty()) {
    for (const std::int32_t body : next) {
      const std::int32_t island = island_of(body);
      if (island < 0) continue;
      now_.is_asleep[index_of(island)] = 0;
      now_.calm_time[index_of(island)] = 0;
    }
    next.clear();
    for (const auto& [a, b] : links) {
      if (island_of(a) < 0 || island_of(b) < 0 || is_asleep(a) == is_asleep(b)) continue;
      next.push_back(is_asleep(a) ? a : b);
    }
  }
  set_still();
  fill(input);
}

double IslandSleep::speed_of(const Island& island, const ModelState& state) const {
  double speed = 0;
  for (const std::int32_t block : island.blocks) {
    const auto k = index_of(block);
    const std::int64_t past = std::int64_t{block} - model_.node_count;
    const bool turns = past >= 0 && past % 2 == 1;
    const double lever = turns ? body_size_[index_of(block_body_[k])] / 2 : 1;
    speed = std::max(speed, lever * norm(state.velocity[k]));
  }
  return speed;
}

bool IslandSleep::is_calm(std::size_t i, const ContactRest& rest, const ModelState& state) const {
  const Island& island = islands_[i];
  for (const std::int32_t body : island.bodies) {
    if (is_driven_[index_of(body)] != 0) return false;
    if (!rest.is_restless.empty() && rest.is_restless[index_of(body)] != 0) return false;
  }
  return speed_of(island, state) <= rest_speed * island.size;
}

/// Sets parent_ to a forest of the islands that links join.
void IslandSleep::join(std::span<const BodyLink> links) const {
  parent_.resize(islands_.size());
  for (std::size_t i = 0; i < parent_.size(); ++i) parent_[i] = static_cast<std::int32_t>(i);
  for (const auto& [a, b] : links) {
    if (island_of(a) < 0 || island_of(b) < 0) continue;
    const std::int32_t first = root_of(parent_, index_of(island_of(a)));
    const std::int32_t second = root_of(parent_, index_of(island_of(b)));
    parent_[index_of(std::max(first, second))] = std::min(first, second);
  }
}

std::int64_t IslandSleep::group_count(std::span<const BodyLink> links) const {
  join(links);
  std::int64_t count = 0;
  for (std::size_t i = 0; i < parent_.size(); ++i) {
    count += now_.is_asleep[i] != 0 && index_of(parent_[i]) == i;
  }
  return count;
}

bool IslandSleep::end(const StepInput& input,
                      const ContactRest& rest,
                      double time_step,
                      ModelState& state) {
  if (!is_on_) return false;
  std::vector<std::uint8_t> is_ready(islands_.size());
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    if (now_.is_asleep[i] != 0) continue;
    const std::uint64_t inputs = hash_of(islands_[i], input);
    const bool is_pulled =
        std::any_of(islands_[i].driven.begin(), islands_[i].driven.end(),
                    [&](std::int32_t block) { return moves(block, state, input); });
    const bool rests = inputs == now_.inputs[i] && !is_pulled && is_calm(i, rest, state);
    now_.inputs[i] = inputs;
    now_.calm_time[i] = rests ? now_.calm_time[i] + time_step : 0;
    is_ready[i] = now_.calm_time[i] >= rest_time * (1 - 1e-9);
  }
  for (const auto& [a, b] : rest.links) {
    const std::int32_t of_a = island_of(a), of_b = island_of(b);
    if (of_a < 0 && of_b >= 0 && is_driven_[index_of(a)] != 0) is_ready[index_of(of_b)] = 0;
    if (of_b < 0 && of_a >= 0 && is_driven_[index_of(b)] != 0) is_ready[index_of(of_a)] = 0;
  }
  join(rest.links);
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    if (is_ready[i] == 0) is_ready[index_of(root_of(parent_, i))] = 0;
  }
  bool has_slept = false;
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    if (now_.is_asleep[i] != 0 || is_ready[i] == 0) continue;
    if (is_ready[index_of(root_of(parent_, i))] == 0) continue;
    now_.is_asleep[i] = 1;
    has_slept = true;
    for (const std::int32_t block : islands_[i].blocks) {
      state.velocity[index_of(block)] = {0, 0, 0};
      const std::int64_t past = std::int64_t{block} - model_.node_count;
      if (past >= 0 && past % 2 == 1) state.angular_momentum[index_of(past / 2)] = {0, 0, 0};
    }
  }
  if (has_slept) set_still();
  return has_slept;
}

}  // namespace tetwarp
