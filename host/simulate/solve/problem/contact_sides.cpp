/// @file contact_sides.cpp
/// Finds the nodes or the frame of each side.
#include "host/simulate/solve/problem/contact_sides.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"

namespace tetwarp {
namespace {

ContactSide side_of(const SceneSurfaces& scene,
                    std::span<const std::int32_t> frames,
                    std::int32_t body,
                    const MaterialPoint& material,
                    const Point3& point) {
  ContactSide side;
  std::copy(point.begin(), point.end(), side.point);
  if (material.is_rigid()) {
    side.frame = frames[index_of(body)];
    return side;
  }
  const std::int32_t first = scene.surfaces.bodies[index_of(body)].first_vertex;
  for (std::size_t k = 0; k < 3; ++k) {
    if (material.vertex[k] < 0) continue;
    side.vertex[k] = first + material.vertex[k];
    side.weight[k] = material.weight[k];
  }
  return side;
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

void set_contact_sides(const SceneSurfaces& scene,
                       std::span<const std::int32_t> frames,
                       std::span<const TrackedContact> contacts,
                       int threads,
                       std::vector<ContactSides>& sides) {
  sides.resize(contacts.size());
  parallel_for(threads, std::ssize(contacts), [&](std::int64_t c) {
    const TrackedContact& from = contacts[index_of(c)];
    ContactSides& to = sides[index_of(c)];
    for (std::size_t k = 0; k < 3; ++k) std::copy_n(from.axes[k].data(), 3, to.axes + 3 * k);
    to.a = side_of(scene, frames, from.key.body_a, from.material_a, from.point_a_world);
    to.b = side_of(scene, frames, from.key.body_b, from.material_b, from.point_b_world);
  });
}

}  // namespace tetwarp
