/// @file expected_motion.cpp
/// Adds the change of the last step by contact where it is likely to happen again.
#include "host/simulate/contact_step/expected_motion.hpp"

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

// Changes are added to a body where the sum of squares of its accelerations with them is less than
// this share of that without. It is near 0 where contact holds a body as before, and 1 or more
// after an impact.
constexpr double holding_share = 0.3;

}  // namespace

void expect_contacts(const Model& model,
                     const ModelState& start,
                     const std::vector<Point3>& change,
                     std::vector<Point3>& velocity) {
  const auto expect_of_blocks = [&](std::int32_t begin, std::int32_t end) {
    double with = 0, without = 0;
    for (std::size_t i = index_of(begin); i < index_of(end); ++i) {
      const Point3 gained = minus(velocity[i], start.velocity[i]);
      const Point3 changed = plus(gained, change[i]);
      without += dot(gained, gained);
      with += dot(changed, changed);
    }
    if (!(with < holding_share * without)) return;
    for (std::size_t i = index_of(begin); i < index_of(end); ++i) {
      velocity[i] = plus(velocity[i], change[i]);
    }
  };
  for (std::size_t b = 0; b + 1 < model.body_node.size(); ++b) {
    expect_of_blocks(model.body_node[b], model.body_node[b + 1]);
  }
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    const std::int32_t first = model.node_count + 2 * r;
    expect_of_blocks(first, first + 2);
  }
}

}  // namespace tetwarp
