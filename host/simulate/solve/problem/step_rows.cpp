/// @file step_rows.cpp
/// Sets rows when a solver asks for them.
#include "host/simulate/solve/problem/step_rows.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"

namespace tetwarp {

StepRows::StepRows(const SceneSurfaces& scene, const Model& model, int threads)
    : scene_(scene), model_(model), threads_(threads), frames_(frames_of_bodies(scene, model)) {
  for (const ModelPoint& point : scene.vertex_point) {
    has_prescribed_.push_back(is_frame_prescribed(point.rigid) ||
                              std::ranges::any_of(point.node, [&](std::int32_t n) {
                                return n >= 0 && is_prescribed(n);
                              }));
  }
}

bool StepRows::is_prescribed(std::int32_t block) const {
  return model_.prescribed[index_of(block)] != 0;
}

bool StepRows::is_frame_prescribed(std::int32_t frame) const {
  return frame >= 0 && is_prescribed(model_.node_count + 2 * frame);
}

bool StepRows::has_prescribed(const ContactSide& side) const {
  return is_frame_prescribed(side.frame) || std::ranges::any_of(side.vertex, [&](std::int32_t v) {
           return v >= 0 && has_prescribed_[index_of(v)] != 0;
         });
}

void StepRows::begin(const ModelState& state, std::span<const TrackedContact> contacts) {
  state_ = &state;
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
  takes_.assign(sides_.size(), 1);
  for (const std::int32_t c : on_device) {
    const ContactSides& of = sides_[index_of(c)];
    takes_[index_of(c)] = has_prescribed(of.a) || has_prescribed(of.b);
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
  for (std::size_t c = 0; c < sides_.size(); ++c) {
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
