#include "host/simulate/contact/step_rows.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>

namespace tetwarp {

StepRows::StepRows(const SceneSurfaces& scene, const Model& model, int threads)
    : scene_(scene),
      model_(model),
      threads_(threads),
      frames_(frames_of_bodies(scene, model)),
      has_prescribed_(frames_.size()) {
  const auto frame_is = [&](std::int32_t frame) {
    return frame >= 0 && is_prescribed(model.node_count + 2 * frame);
  };
  for (std::size_t b = 0; b < frames_.size(); ++b) has_prescribed_[b] = frame_is(frames_[b]);
  for (std::size_t v = 0; v < scene.vertex_point.size(); ++v) {
    const ModelPoint& point = scene.vertex_point[v];
    const bool is = frame_is(point.rigid) || std::ranges::any_of(point.node, [&](std::int32_t n) {
                      return n >= 0 && is_prescribed(n);
                    });
    if (is) has_prescribed_[index_of(scene.surfaces.vertex_body[v])] = 1;
  }
}

bool StepRows::is_prescribed(std::int32_t block) const {
  return model_.prescribed[index_of(block)] != 0;
}

void StepRows::begin(const ModelState& state, std::span<const TrackedContact> contacts) {
  state_ = &state;
  contacts_ = contacts;
  has_all_ = false;
  set_contact_sides(scene_, frames_, contacts, threads_, sides_);
}

void StepRows::set(std::span<const std::uint8_t> takes) {
  set_contact_rows(scene_, model_, *state_, sides_, takes, threads_, rows_);
}

void StepRows::set_all() {
  if (!has_all_) set({});
  has_all_ = true;
}

void StepRows::set_for_host(std::span<const std::int32_t> on_device) {
  takes_.assign(contacts_.size(), 1);
  for (const std::int32_t c : on_device) {
    const ContactKey& key = contacts_[index_of(c)].key;
    takes_[index_of(c)] =
        has_prescribed_[index_of(key.body_a)] != 0 || has_prescribed_[index_of(key.body_b)] != 0;
  }
  set(takes_);
}

Point3 StepRows::prescribed_velocity(std::size_t contact,
                                     const std::vector<Point3>& velocity) const {
  Point3 sum{0, 0, 0};
  for (std::int32_t e = rows_.start[contact]; e < rows_.start[contact + 1]; ++e) {
    const std::int32_t block = rows_.block[index_of(e)];
    if (!is_prescribed(block)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        sum[k] += rows_.value[index_of(e)][3 * k + i] * velocity[index_of(block)][i];
      }
    }
  }
  return sum;
}

void StepRows::prescribed_impulses(std::span<const double> impulse,
                                   std::vector<Point3>& sums) const {
  sums.assign(index_of(model_.block_count()), Point3{0, 0, 0});
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const double* const r = impulse.data() + 3 * c;
    if (r[0] == 0 && r[1] == 0 && r[2] == 0) continue;
    for (std::int32_t e = rows_.start[c]; e < rows_.start[c + 1]; ++e) {
      const std::int32_t block = rows_.block[index_of(e)];
      if (!is_prescribed(block)) continue;
      Point3& own = sums[index_of(block)];
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          own[i] += rows_.value[index_of(e)][3 * axis + i] * r[axis];
        }
      }
    }
  }
}

}  // namespace tetwarp
