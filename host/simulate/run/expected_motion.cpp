#include "host/simulate/run/expected_motion.hpp"

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

// Contacts hold where, with their changes, the square of the change of velocity over the step is
// at most this part of that without. Right after an impact it is not: its changes do not come
// again.
constexpr double holding = 0.3;

}  // namespace

void expect_contacts(const Model& model,
                     const ModelState& start,
                     const std::vector<Point3>& change,
                     std::vector<Point3>& velocity) {
  const auto expect = [&](std::int32_t begin, std::int32_t end) {
    double with = 0, without = 0;
    for (std::size_t i = index_of(begin); i < index_of(end); ++i) {
      const Point3 way = minus(velocity[i], start.velocity[i]), changed = plus(way, change[i]);
      without += dot(way, way);
      with += dot(changed, changed);
    }
    if (!(with < holding * without)) return;
    for (std::size_t i = index_of(begin); i < index_of(end); ++i) {
      velocity[i] = plus(velocity[i], change[i]);
    }
  };
  for (std::size_t b = 0; b + 1 < model.body_node.size(); ++b) {
    expect(model.body_node[b], model.body_node[b + 1]);
  }
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    const std::int32_t first = model.node_count + 2 * r;
    expect(first, first + 2);
  }
}

}  // namespace tetwarp
