#include "host/simulate/contact/contact_rows.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

/// Appends the arms of contacts, one contact after the other.
class RowMaker {
 public:
  RowMaker(const SceneSurfaces& scene,
           const Model& model,
           std::span<const std::int32_t> frames,
           const ModelState& state,
           ContactRows& rows)
      : scene_(scene), model_(model), frames_(frames), state_(state), rows_(rows) {}

  void add(const TrackedContact& contact) {
    arms_.clear();
    add_side(contact.key.body_a, contact.material_a, contact.point_a_world, 1);
    add_side(contact.key.body_b, contact.material_b, contact.point_b_world, -1);
    std::sort(arms_.begin(), arms_.end(),
              [](const BlockArm& a, const BlockArm& b) { return a.block < b.block; });
    const auto number = static_cast<std::int32_t>(rows_.start.size()) - 1;
    for (const BlockArm& own : arms_) {
      const bool is_frame = own.block >= model_.node_count;
      const auto first = static_cast<std::int32_t>(9 * rows_.block.size());
      rows_.arms.push_back(own.arm);
      rows_.places.push_back({number, first, 3, is_frame ? 9 : 0});
      rows_.block.push_back(own.block);
      if (is_frame) rows_.block.push_back(own.block + 1);
    }
    for (const Point3& axis : contact.axes) {
      rows_.axes.insert(rows_.axes.end(), axis.begin(), axis.end());
    }
    rows_.start.push_back(static_cast<std::int32_t>(rows_.block.size()));
    rows_.arm_start.push_back(static_cast<std::int32_t>(rows_.arms.size()));
  }

 private:
  struct BlockArm {
    std::int32_t block = 0;  ///< of a frame the first one
    ContactArm arm;
  };

  void add_side(std::int32_t body,
                const MaterialPoint& material,
                const Point3& point,
                double sign) {
    if (material.is_rigid()) {
      if (frames_[index_of(body)] >= 0) add_frame(frames_[index_of(body)], point, sign);
      return;
    }
    const std::int32_t first = scene_.surfaces.bodies[index_of(body)].first_vertex;
    for (std::size_t k = 0; k < 3; ++k) {
      if (material.vertex[k] < 0) continue;
      const ModelPoint& vertex = scene_.vertex_point[index_of(first + material.vertex[k])];
      const double weight = sign * material.weight[k];
      if (vertex.rigid >= 0) {
        add_frame(vertex.rigid, point, weight);
        continue;
      }
      for (std::size_t n = 0; n < 4; ++n) {
        if (vertex.node[n] >= 0) arm_of(vertex.node[n]).weight += weight * vertex.weight[n];
      }
    }
  }

  void add_frame(std::int32_t frame, const Point3& point, double weight) {
    const Point3& centre = state_.position[index_of(model_.node_count + frame)];
    ContactArm& arm = arm_of(model_.node_count + 2 * frame);
    arm.weight += weight;
    for (std::size_t i = 0; i < 3; ++i) arm.lever[i] += weight * (point[i] - centre[i]);
  }

  ContactArm& arm_of(std::int32_t block) {
    const auto found = std::find_if(arms_.begin(), arms_.end(),
                                    [&](const BlockArm& arm) { return arm.block == block; });
    if (found != arms_.end()) return found->arm;
    return arms_.emplace_back(BlockArm{block, {}}).arm;
  }

  const SceneSurfaces& scene_;
  const Model& model_;
  std::span<const std::int32_t> frames_;
  const ModelState& state_;
  ContactRows& rows_;
  std::vector<BlockArm> arms_;  ///< of the current contact, each block once
};

}  // namespace

std::vector<std::int32_t> frames_of_bodies(const SceneSurfaces& scene, const Model& model) {
  std::vector<std::int32_t> frames(index_of(scene.body_count()), -1);
  for (std::size_t r = 0; r < model.rigid.body.size(); ++r) {
    const std::size_t body = index_of(model.rigid.body[r]);
    if (body < frames.size()) frames[body] = static_cast<std::int32_t>(r);
  }
  return frames;
}

void set_contact_rows(const SceneSurfaces& scene,
                      const Model& model,
                      std::span<const std::int32_t> frames,
                      const ModelState& state,
                      const std::vector<TrackedContact>& contacts,
                      ContactRows& rows) {
  rows.start.assign(1, 0);
  rows.arm_start.assign(1, 0);
  rows.block.clear();
  rows.axes.clear();
  rows.arms.clear();
  rows.places.clear();
  RowMaker maker(scene, model, frames, state, rows);
  for (const TrackedContact& contact : contacts) maker.add(contact);
  rows.value.resize(rows.block.size());
  const auto count = static_cast<std::int64_t>(rows.arms.size());
  const ContactRowsBody body = {{rows.axes.data(), static_cast<std::int64_t>(rows.axes.size())},
                                {rows.arms.data(), count},
                                {rows.places.data(), count},
                                {reinterpret_cast<double*>(rows.value.data()),
                                 9 * static_cast<std::int64_t>(rows.value.size())}};
  for (std::int64_t a = 0; a < count; ++a) body(a);
}

}  // namespace tetwarp
