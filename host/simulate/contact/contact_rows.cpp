#include "host/simulate/contact/contact_rows.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>
#include <numeric>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

using BlockArm = ContactRows::BlockArm;

/// Finds the arms of contacts.
class ArmMaker {
 public:
  ArmMaker(const SceneSurfaces& scene,
           const Model& model,
           std::span<const std::int32_t> frames,
           const ModelState& state)
      : scene_(scene), model_(model), frames_(frames), state_(state) {}

  /// Appends those of a contact, sorted by block.
  void add(const TrackedContact& contact, std::vector<BlockArm>& arms) {
    first_ = arms.size();
    arms_ = &arms;
    add_side(contact.key.body_a, contact.material_a, contact.point_a_world, 1);
    add_side(contact.key.body_b, contact.material_b, contact.point_b_world, -1);
    std::sort(begin(), arms.end(),
              [](const BlockArm& a, const BlockArm& b) { return a.block < b.block; });
  }

 private:
  std::vector<BlockArm>::iterator begin() {
    return arms_->begin() + static_cast<std::ptrdiff_t>(first_);
  }

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
    const auto found = std::find_if(begin(), arms_->end(),
                                    [&](const BlockArm& arm) { return arm.block == block; });
    if (found != arms_->end()) return found->arm;
    return arms_->emplace_back(BlockArm{block, {}}).arm;
  }

  const SceneSurfaces& scene_;
  const Model& model_;
  std::span<const std::int32_t> frames_;
  const ModelState& state_;
  std::vector<BlockArm>* arms_ = nullptr;
  std::size_t first_ = 0;  ///< of the current contact, which has each block once
};

constexpr std::size_t part_size = 64;  // contacts that one task takes

/// task(part, first contact, past its last one)
template <class Task>
void for_parts(int threads, std::size_t contacts, const Task& task) {
  parallel_tasks(threads, static_cast<std::int64_t>((contacts + part_size - 1) / part_size),
                 [&](std::int64_t p) {
                   const std::size_t part = index_of(p), first = part_size * part;
                   task(part, first, std::min(contacts, first + part_size));
                 });
}

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
                      int threads,
                      ContactRows& rows) {
  const std::size_t count = contacts.size();
  const auto is_frame = [&](const BlockArm& arm) { return arm.block >= model.node_count; };
  rows.start.assign(count + 1, 0);
  rows.arm_start.assign(count + 1, 0);
  rows.parts.resize((count + part_size - 1) / part_size);
  for_parts(threads, count, [&](std::size_t part, std::size_t first, std::size_t end) {
    ArmMaker maker(scene, model, frames, state);
    std::vector<BlockArm>& own = rows.parts[part];
    own.clear();
    for (std::size_t c = first; c < end; ++c) {
      const std::size_t before = own.size();
      maker.add(contacts[c], own);
      const std::span<const BlockArm> arms = std::span<const BlockArm>(own).subspan(before);
      rows.arm_start[c + 1] = static_cast<std::int32_t>(arms.size());
      rows.start[c + 1] =
          static_cast<std::int32_t>(std::ssize(arms) + std::ranges::count_if(arms, is_frame));
    }
  });
  for (auto* const sums : {&rows.start, &rows.arm_start}) {
    std::partial_sum(sums->begin(), sums->end(), sums->begin());
  }
  rows.block.resize(index_of(rows.start[count]));
  rows.value.resize(rows.block.size());
  rows.arms.resize(index_of(rows.arm_start[count]));
  rows.places.resize(rows.arms.size());
  rows.axes.resize(9 * count);
  const auto arm_count = static_cast<std::int64_t>(rows.arms.size());
  const ContactRowsBody body = {{rows.axes.data(), static_cast<std::int64_t>(rows.axes.size())},
                                {rows.arms.data(), arm_count},
                                {rows.places.data(), arm_count},
                                {reinterpret_cast<double*>(rows.value.data()),
                                 9 * static_cast<std::int64_t>(rows.value.size())}};
  for_parts(threads, count, [&](std::size_t part, std::size_t first, std::size_t end) {
    const BlockArm* own = rows.parts[part].data();
    for (std::size_t c = first; c < end; ++c) {
      for (std::size_t k = 0; k < 3; ++k) {
        std::copy_n(contacts[c].axes[k].data(), 3, rows.axes.data() + 9 * c + 3 * k);
      }
      std::int32_t next = rows.start[c];
      for (std::int32_t a = rows.arm_start[c]; a < rows.arm_start[c + 1]; ++a, ++own) {
        rows.arms[index_of(a)] = own->arm;
        rows.places[index_of(a)] = {static_cast<std::int32_t>(c), 9 * next, 3,
                                    is_frame(*own) ? 9 : 0};
        rows.block[index_of(next++)] = own->block;
        if (is_frame(*own)) rows.block[index_of(next++)] = own->block + 1;
        body(a);
      }
    }
  });
}

}  // namespace tetwarp
