/// @file island_sleep.hpp
/// IslandSleep: which coupling islands are at rest and are left out of steps until something
/// reaches them.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/base/disjoint_sets.hpp"
#include "host/scene/scene_geometry.hpp"
#include "host/simulate/contact_step/body_link.hpp"
#include "host/simulate/contact_step/contact_rest.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/state/island_lists.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// What goes on from step to step; [islands].
struct SleepState {
  std::vector<std::uint8_t> is_asleep;
  std::vector<double> calm_time;      ///< [s] for which the island has been at rest
  std::vector<std::uint64_t> inputs;  ///< hash of the loads and anchors of the last step
};

/// A coupling island sleeps when, for 0.5 s, its points have moved by less than two thousandths of
/// the size of its smallest body per second, loads, anchors and supports have not changed, and the
/// same holds for all islands that it touches, with contacts that stick. It then stands still,
/// without velocity. It wakes, with all that touches it, when its loads, anchors or supports
/// change, and when something that moves reaches it.
class IslandSleep {
 public:
  static constexpr double rest_time = 0.5;  ///< [s]

  /// @param model  kept by the caller
  IslandSleep(const Scene& scene, const SceneGeometry& geometry, const Model& model);

  /// Whether the scene asks for it; if not, nothing ever sleeps.
  bool is_on() const { return lists_.has_value(); }
  const SleepState& state() const { return now_; }
  void set_state(SleepState state) { now_ = std::move(state); }
  /// Whether bodies are asleep or do not move in the step; [bodies, then obstacles], empty where
  /// nothing sleeps. Valid from begin() on.
  const std::vector<std::uint8_t>& still() const { return still_; }
  /// Islands that sleep, those with a contact between them counted as one.
  std::int64_t group_count(std::span<const BodyLink> links) const;

  /// Before the solve of a step or part of one: wakes the islands whose inputs have changed, and
  /// fills StepInput::is_asleep.
  /// @param links  of contacts between bodies that sleep or are still
  /// @returns whether an island has woken
  bool begin(const ModelState& state, std::span<const BodyLink> links, StepInput& input);
  /// Wakes the islands of the bodies and all that are linked to them; as begin().
  void wake(std::span<const std::int32_t> bodies,
            std::span<const BodyLink> links,
            StepInput& input);
  /// After a step: lets islands fall asleep.
  /// @param input  of its last part
  /// @param state  after it; velocities of islands that fall asleep are set to zero
  /// @returns whether one has fallen asleep
  bool end(const StepInput& input, const ContactRest& rest, double time_step, ModelState& state);
  /// Forgets for how long islands have been at rest.
  void interrupt();

 private:
  using Island = IslandLists::Island;

  bool is_asleep(std::int32_t body) const;
  bool any_asleep() const;
  bool is_driven(std::int32_t body) const;
  bool moves(std::int32_t block, const ModelState& state, const StepInput& input) const;
  bool any_moves(const std::vector<std::int32_t>& blocks,
                 const ModelState& state,
                 const StepInput& input) const;
  void note_what_moves(const ModelState& state, const StepInput& input);
  void set_still();
  void fill(StepInput& input) const;
  DisjointSets joined(std::span<const BodyLink> links) const;
  std::uint64_t hash_of(const Island& island, const StepInput& input) const;
  double speed_of(const Island& island, const ModelState& state) const;
  bool is_calm(const Island& island, const ContactRest& rest, const ModelState& state) const;
  std::vector<std::uint8_t> count_calm_time(const StepInput& input,
                                            const ContactRest& rest,
                                            double time_step,
                                            const ModelState& state);
  void keep_awake_beside_driven(std::span<const BodyLink> links,
                                std::vector<std::uint8_t>& is_ready) const;
  bool fall_asleep(std::span<const BodyLink> links,
                   std::vector<std::uint8_t> is_ready,
                   ModelState& state);
  void stand_still(const Island& island, ModelState& state) const;

  std::optional<IslandLists> lists_;  ///< none: nothing ever sleeps
  SleepState now_;
  std::vector<std::uint8_t> is_driven_;  ///< [bodies, then obstacles] a prescribed block moves
  std::vector<std::uint8_t> still_;
};

}  // namespace tetwarp
