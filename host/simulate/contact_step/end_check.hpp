/// @file end_check.hpp
/// EndCheck: shortens the motions of bodies that would come too near at the end of a part of a
/// step.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/collide/detector.hpp"
#include "host/simulate/contact_step/body_link.hpp"
#include "host/simulate/contact_step/contact_part.hpp"
#include "host/simulate/contact_step/part_motion.hpp"
#include "host/simulate/contact_step/step_groups.hpp"

namespace tetwarp {

class EndCheck {
 public:
  /// @param surfaces, model, detector, motion  kept by the caller
  EndCheck(const SceneSurfaces& surfaces,
           const Model& model,
           Detector& detector,
           PartMotion& motion);

  /// Joins the islands that contacts tie; all bodies move the whole part.
  /// @param contacts  null: none
  /// @param sleeping  bodies of contacts that are not solved
  void begin(const std::vector<TrackedContact>* contacts, std::span<const BodyLink> sleeping);
  /// Contact islands.
  std::int64_t island_count() { return groups_.island_count(); }
  /// Checks the last motion and shortens it until no pair comes too near.
  void run(ContactPart& part);

  /// Of the part, [bodies, then obstacles], that each body and obstacle moves.
  const std::vector<double>& fractions() const { return groups_.fractions(); }
  bool all_move() const { return groups_.all_move(); }

 private:
  bool is_script(std::size_t body) const;
  std::int64_t stalled_scripts() const;

  const SceneSurfaces& surfaces_;
  const Model& model_;
  Detector& detector_;
  PartMotion& motion_;
  StepGroups groups_;
};

}  // namespace tetwarp
