/// @file end_check.cpp
/// Checks the motion of a part of a step and stops the groups of bodies that would come too near.
#include "host/simulate/contact_step/end_check.hpp"

#include "host/base/index_of.hpp"

namespace tetwarp {

EndCheck::EndCheck(const SceneSurfaces& surfaces,
                   const Model& model,
                   Detector& detector,
                   PartMotion& motion)
    : surfaces_(surfaces),
      model_(model),
      detector_(detector),
      motion_(motion),
      groups_(model, surfaces.surfaces) {}

void EndCheck::begin(const std::vector<TrackedContact>* contacts,
                     std::span<const BodyLink> sleeping) {
  static const std::vector<TrackedContact> none;
  groups_.begin(contacts == nullptr ? none : *contacts, sleeping);
}

void EndCheck::run(ContactPart& part) {
  bool is_whole = true;
  for (;;) {
    const std::vector<TouchingPair>& hits = detector_.check(motion_.last());
    // The groups see in the whole motion which bodies move.
    if (is_whole && !hits.empty()) motion_.find_vertices();
    if (!groups_.stop(hits, motion_.last())) break;
    is_whole = false;
    motion_.shorten(groups_.fractions());
  }
  part.smallest_fraction = groups_.smallest_fraction();
  if (groups_.all_move()) return;
  part.clamped_islands = groups_.stopped_islands();
  part.stalled_scripts = stalled_scripts();
}

/// Whether a script, driven nodes or the path of an obstacle move a body in this part.
bool EndCheck::is_script(std::size_t body) const {
  const auto is_driven = [&](std::int32_t block) {
    const std::size_t k = index_of(block);
    return model_.prescribed[k] != 0 && motion_.velocity()[k] != Point3{0, 0, 0};
  };
  if (body + 1 < model_.body_node.size()) {
    for (auto n = model_.body_node[body]; n < model_.body_node[body + 1]; ++n) {
      if (is_driven(n)) return true;
    }
  }
  const std::int32_t rigid = surfaces_.body_rigid[body];
  if (rigid < 0) return false;
  const std::int32_t block = model_.node_count + 2 * rigid;
  return is_driven(block) || is_driven(block + 1);
}

std::int64_t EndCheck::stalled_scripts() const {
  std::int64_t count = 0;
  for (std::size_t b = 0; b < fractions().size(); ++b) count += fractions()[b] < 1 && is_script(b);
  return count;
}

}  // namespace tetwarp
