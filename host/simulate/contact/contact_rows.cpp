#include "host/simulate/contact/contact_rows.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>
#include <utility>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

/// Appends the blocks of contacts, one contact after the other.
class RowMaker {
 public:
  RowMaker(const SceneSurfaces& scene,
           const Model& model,
           std::span<const std::int32_t> frames,
           const ModelState& state,
           ContactRows& rows)
      : scene_(scene), model_(model), frames_(frames), state_(state), rows_(rows) {}

  void add(const TrackedContact& contact) {
    first_ = rows_.block.size();
    axes_ = &contact.axes;
    add_side(contact.key.body_a, contact.material_a, contact.point_a_world, 1);
    add_side(contact.key.body_b, contact.material_b, contact.point_b_world, -1);
    sort();
    rows_.start.push_back(static_cast<std::int32_t>(rows_.block.size()));
  }

 private:
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
        if (vertex.node[n] >= 0) add_linear(vertex.node[n], weight * vertex.weight[n]);
      }
    }
  }

  void add_frame(std::int32_t frame, const Point3& point, double weight) {
    const std::int32_t linear = model_.node_count + 2 * frame;
    const Point3& centre = state_.position[index_of(model_.node_count + frame)];
    Point3 arm;
    for (std::size_t i = 0; i < 3; ++i) arm[i] = point[i] - centre[i];
    add_linear(linear, weight);
    std::array<double, 9>& value = value_of(linear + 1);
    for (std::size_t k = 0; k < 3; ++k) {
      const Point3 lever = cross(arm, (*axes_)[k]);
      for (std::size_t i = 0; i < 3; ++i) value[3 * k + i] += weight * lever[i];
    }
  }

  void add_linear(std::int32_t block, double weight) {
    std::array<double, 9>& value = value_of(block);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) value[3 * k + i] += weight * (*axes_)[k][i];
    }
  }

  std::array<double, 9>& value_of(std::int32_t block) {
    const auto begin = rows_.block.begin() + static_cast<std::ptrdiff_t>(first_);
    const auto found = std::find(begin, rows_.block.end(), block);
    const auto place = static_cast<std::size_t>(found - rows_.block.begin());
    if (found == rows_.block.end()) {
      rows_.block.push_back(block);
      rows_.value.push_back({});
    }
    return rows_.value[place];
  }

  void sort() {
    for (std::size_t i = first_ + 1; i < rows_.block.size(); ++i) {
      for (std::size_t k = i; k > first_ && rows_.block[k] < rows_.block[k - 1]; --k) {
        std::swap(rows_.block[k], rows_.block[k - 1]);
        std::swap(rows_.value[k], rows_.value[k - 1]);
      }
    }
  }

  const SceneSurfaces& scene_;
  const Model& model_;
  std::span<const std::int32_t> frames_;
  const ModelState& state_;
  ContactRows& rows_;
  std::size_t first_ = 0;                        ///< entry of the current contact
  const std::array<Point3, 3>* axes_ = nullptr;  ///< of the current contact
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
  rows.block.clear();
  rows.value.clear();
  RowMaker maker(scene, model, frames, state, rows);
  for (const TrackedContact& contact : contacts) maker.add(contact);
}

}  // namespace tetwarp
