/// @file island_sleep.cpp
/// Decides by speeds and times which islands sleep.
#include "host/simulate/state/island_sleep.hpp"

#include <algorithm>
#include <limits>

#include "host/base/index_of.hpp"
#include "host/base/number_hash.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();

void add_to(NumberHash& hash, const Point3& x) {
  for (const double number : x) hash.add(number + 0.0);  // -0 as 0
}

}  // namespace

IslandSleep::IslandSleep(const Scene& scene, const SceneGeometry& geometry, const Model& model) {
  if (!scene.solver.sleeping) return;
  lists_.emplace(scene, geometry, model);
  const std::size_t count = lists_->islands().size();
  now_ = {std::vector<std::uint8_t>(count), std::vector<double>(count),
          std::vector<std::uint64_t>(count)};
  is_driven_.resize(lists_->body_count());
}

bool IslandSleep::is_asleep(std::int32_t body) const {
  const std::int32_t island = lists_->island_of(body);
  return island >= 0 && at(now_.is_asleep, island) != 0;
}

bool IslandSleep::any_asleep() const {
  return std::find(now_.is_asleep.begin(), now_.is_asleep.end(), 1) != now_.is_asleep.end();
}

bool IslandSleep::is_driven(std::int32_t body) const {
  return at(is_driven_, body) != 0;
}

void IslandSleep::interrupt() {
  std::fill(now_.calm_time.begin(), now_.calm_time.end(), 0);
}

/// Whether a prescribed block moves by more than the rounding of its place.
bool IslandSleep::moves(std::int32_t block, const ModelState& state, const StepInput& input) const {
  const double moved = norm(at(input.prescribed_velocity, block)) * input.time_step;
  if (moved == 0) return false;
  if (lists_->turning_frame(block) >= 0) return moved > rounding;
  return moved > rounding * (norm(lists_->place_of(block, state)) + lists_->size_of(block));
}

bool IslandSleep::any_moves(const std::vector<std::int32_t>& blocks,
                            const ModelState& state,
                            const StepInput& input) const {
  return std::any_of(blocks.begin(), blocks.end(),
                     [&](std::int32_t block) { return moves(block, state, input); });
}

void IslandSleep::note_what_moves(const ModelState& state, const StepInput& input) {
  for (std::size_t b = 0; b < is_driven_.size(); ++b) {
    is_driven_[b] = any_moves(lists_->driven_of(b), state, input);
  }
}

std::uint64_t IslandSleep::hash_of(const Island& island, const StepInput& input) const {
  NumberHash hash;
  for (const std::int32_t block : island.blocks) add_to(hash, at(input.block_force, block));
  for (const std::int32_t s : island.springs) {
    const bool is_active = at(input.is_active, s) != 0;
    hash.add(is_active ? 1.0 : 0.0);
    if (is_active) add_to(hash, at(input.anchor, s));
  }
  return hash.value();
}

void IslandSleep::set_still() {
  still_.clear();
  if (!any_asleep()) return;
  still_.resize(lists_->body_count());
  for (std::size_t b = 0; b < still_.size(); ++b) {
    const auto body = static_cast<std::int32_t>(b);
    still_[b] = lists_->island_of(body) >= 0 ? is_asleep(body) : !is_driven(body);
  }
}

void IslandSleep::fill(StepInput& input) const {
  input.is_asleep.clear();
  if (still_.empty()) return;
  input.is_asleep.assign(lists_->block_count(), 0);
  for (std::size_t i = 0; i < now_.is_asleep.size(); ++i) {
    if (now_.is_asleep[i] == 0) continue;
    const Island& island = lists_->islands()[i];
    for (const std::int32_t block : island.blocks) input.is_asleep[index_of(block)] = 1;
    for (const std::int32_t block : island.driven) {
      input.prescribed_velocity[index_of(block)] = {0, 0, 0};
    }
  }
}

bool IslandSleep::begin(const ModelState& state,
                        std::span<const BodyLink> links,
                        StepInput& input) {
  if (!is_on()) return false;
  note_what_moves(state, input);
  std::vector<std::int32_t> woken;
  for (std::size_t i = 0; i < now_.is_asleep.size(); ++i) {
    const Island& island = lists_->islands()[i];
    if (now_.is_asleep[i] == 0) continue;
    const bool is_pulled = any_moves(island.driven, state, input);
    if (is_pulled || hash_of(island, input) != now_.inputs[i]) woken.push_back(island.bodies[0]);
  }
  for (const auto& [a, b] : links) {
    if (is_driven(a) && is_asleep(b)) woken.push_back(b);
    if (is_driven(b) && is_asleep(a)) woken.push_back(a);
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
      const std::int32_t island = lists_->island_of(body);
      if (island < 0) continue;
      now_.is_asleep[index_of(island)] = 0;
      now_.calm_time[index_of(island)] = 0;
    }
    next.clear();
    for (const auto& [a, b] : links) {
      if (lists_->island_of(a) < 0 || lists_->island_of(b) < 0) continue;
      if (is_asleep(a) != is_asleep(b)) next.push_back(is_asleep(a) ? a : b);
    }
  }
  set_still();
  fill(input);
}

double IslandSleep::speed_of(const Island& island, const ModelState& state) const {
  double speed = 0;
  for (const std::int32_t block : island.blocks) {
    const bool turns = lists_->turning_frame(block) >= 0;
    const double lever = turns ? lists_->size_of(block) / 2 : 1;
    speed = std::max(speed, lever * norm(at(state.velocity, block)));
  }
  return speed;
}

bool IslandSleep::is_calm(const Island& island,
                          const ContactRest& rest,
                          const ModelState& state) const {
  for (const std::int32_t body : island.bodies) {
    if (is_driven(body)) return false;
    if (!rest.is_restless.empty() && at(rest.is_restless, body) != 0) return false;
  }
  return speed_of(island, state) <= rest_speed * island.size;
}

/// Sets of islands that links join.
DisjointSets IslandSleep::joined(std::span<const BodyLink> links) const {
  DisjointSets sets(now_.is_asleep.size());
  for (const auto& [a, b] : links) {
    const std::int32_t of_a = lists_->island_of(a), of_b = lists_->island_of(b);
    if (of_a >= 0 && of_b >= 0) sets.unite(index_of(of_a), index_of(of_b));
  }
  return sets;
}

std::int64_t IslandSleep::group_count(std::span<const BodyLink> links) const {
  if (!is_on()) return 0;
  DisjointSets sets = joined(links);
  std::int64_t count = 0;
  for (std::size_t i = 0; i < now_.is_asleep.size(); ++i) {
    count += now_.is_asleep[i] != 0 && sets.root_of(i) == i;
  }
  return count;
}

bool IslandSleep::end(const StepInput& input,
                      const ContactRest& rest,
                      double time_step,
                      ModelState& state) {
  if (!is_on()) return false;
  std::vector<std::uint8_t> is_ready = count_calm_time(input, rest, time_step, state);
  keep_awake_beside_driven(rest.links, is_ready);
  const bool has_slept = fall_asleep(rest.links, std::move(is_ready), state);
  if (has_slept) set_still();
  return has_slept;
}

/// @returns of each island whether it has been at rest for long enough
std::vector<std::uint8_t> IslandSleep::count_calm_time(const StepInput& input,
                                                       const ContactRest& rest,
                                                       double time_step,
                                                       const ModelState& state) {
  std::vector<std::uint8_t> is_ready(now_.is_asleep.size());
  for (std::size_t i = 0; i < is_ready.size(); ++i) {
    if (now_.is_asleep[i] != 0) continue;
    const Island& island = lists_->islands()[i];
    const std::uint64_t inputs = hash_of(island, input);
    const bool rests = inputs == now_.inputs[i] && !any_moves(island.driven, state, input) &&
                       is_calm(island, rest, state);
    now_.inputs[i] = inputs;
    now_.calm_time[i] = rests ? now_.calm_time[i] + time_step : 0;
    is_ready[i] = now_.calm_time[i] >= rest_time * (1 - 1e-9);
  }
  return is_ready;
}

/// Islands that touch a driven body or obstacle are not ready.
void IslandSleep::keep_awake_beside_driven(std::span<const BodyLink> links,
                                           std::vector<std::uint8_t>& is_ready) const {
  for (const auto& [a, b] : links) {
    const std::int32_t of_a = lists_->island_of(a), of_b = lists_->island_of(b);
    if (of_a < 0 && of_b >= 0 && is_driven(a)) is_ready[index_of(of_b)] = 0;
    if (of_b < 0 && of_a >= 0 && is_driven(b)) is_ready[index_of(of_a)] = 0;
  }
}

/// Islands fall asleep where all that links join are ready.
/// @returns whether one has fallen asleep
bool IslandSleep::fall_asleep(std::span<const BodyLink> links,
                              std::vector<std::uint8_t> is_ready,
                              ModelState& state) {
  DisjointSets sets = joined(links);
  for (std::size_t i = 0; i < is_ready.size(); ++i) {
    if (is_ready[i] == 0) is_ready[sets.root_of(i)] = 0;
  }
  bool has_slept = false;
  for (std::size_t i = 0; i < is_ready.size(); ++i) {
    if (now_.is_asleep[i] != 0 || is_ready[i] == 0 || is_ready[sets.root_of(i)] == 0) continue;
    now_.is_asleep[i] = 1;
    has_slept = true;
    stand_still(lists_->islands()[i], state);
  }
  return has_slept;
}

void IslandSleep::stand_still(const Island& island, ModelState& state) const {
  for (const std::int32_t block : island.blocks) {
    state.velocity[index_of(block)] = {0, 0, 0};
    const std::int32_t frame = lists_->turning_frame(block);
    if (frame >= 0) state.angular_momentum[index_of(frame)] = {0, 0, 0};
  }
}

}  // namespace tetwarp
