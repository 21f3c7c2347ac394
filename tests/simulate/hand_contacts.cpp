#include "tests/simulate/hand_contacts.hpp"

#include <algorithm>

#include "host/simulate/model/rotations.hpp"
#include "host/simulate/solve/problem/contact_rows.hpp"
#include "host/simulate/solve/problem/contact_sides.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
void HandScene::make_surfaces(double body_size) {
  const std::size_t bodies = model.body_rigid.size();
  surfaces = {};
  surfaces.surfaces.bodies.resize(bodies);
  surfaces.body_size.assign(bodies, body_size);
  for (std::size_t b = 0; b < bodies; ++b) {
    CollisionBody& body = surfaces.surfaces.bodies[b];
    body.first_vertex = model.body_node[b];
    body.vertex_end = model.body_node[b + 1];
    body.is_rigid = model.body_rigid[b] >= 0;
  }
  for (std::int32_t n = 0; n < model.node_count; ++n) {
    surfaces.vertex_point.push_back(node_point(model, n));
  }
  for (std::size_t b = 0; b < bodies; ++b) {
    surfaces.surfaces.vertex_body.resize(at(model.body_node[b + 1]), static_cast<std::int32_t>(b));
  }
}

Point3 HandScene::place_of(std::int32_t body,
                           const MaterialPoint& point,
                           const ModelState& state) const {
  Point3 place{0, 0, 0};
  if (point.is_rigid()) {
    const std::int32_t frame = model.body_rigid[at(body)];
    const Point3 arm = rotate(state.rotation[at(frame)], point.local);
    const Point3& center = state.position[at(model.node_count + frame)];
    for (std::size_t i = 0; i < 3; ++i) place[i] = center[i] + arm[i];
    return place;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (point.vertex[k] < 0) continue;
    const Point3& node = state.position[at(model.body_node[at(body)] + point.vertex[k])];
    for (std::size_t i = 0; i < 3; ++i) place[i] += point.weight[k] * node[i];
  }
  return place;
}

std::vector<ReportedContact> HandScene::reports(const ModelState& state) const {
  std::vector<ReportedContact> result;
  for (std::size_t t = 0; t < touches.size(); ++t) {
    const Touch& touch = touches[t];
    const auto feature = static_cast<std::int32_t>(2 * t);
    ReportedContact report;
    report.key = {touch.body_a, feature, touch.body_b, feature + 1};
    report.point_a_world = place_of(touch.body_a, touch.point_a, state);
    report.point_b_world = place_of(touch.body_b, touch.point_b, state);
    report.normal = touch.normal;
    report.area = touch.area;
    report.material = touch.material;
    report.obstacle_velocity = touch.obstacle_velocity;
    report.material_a = touch.point_a;
    report.material_b = touch.point_b;
    result.push_back(report);
  }
  return result;
}

std::vector<BodyPlace> HandScene::places(const ModelState& state) const {
  std::vector<BodyPlace> result(model.body_rigid.size());
  for (std::size_t b = 0; b < result.size(); ++b) {
    const std::int32_t frame = model.body_rigid[b];
    if (frame >= 0) {
      result[b].pose = {state.position[at(model.node_count + frame)], state.rotation[at(frame)]};
    } else {
      result[b].vertices =
          std::span(state.position)
              .subspan(at(model.body_node[b]), at(model.body_node[b + 1] - model.body_node[b]));
    }
  }
  return result;
}

std::vector<TrackedContact> HandScene::begin(ContactTracker& tracker,
                                             const ModelState& state,
                                             double time_step) const {
  return tracker.begin_step(reports(state), places(state), time_step);
}

std::vector<Point3> HandScene::block_impulses(const ModelState& state,
                                              const std::vector<TrackedContact>& contacts,
                                              const std::vector<double>& impulse) const {
  std::vector<ContactSides> sides;
  set_contact_sides(surfaces, frames_of_bodies(surfaces, model), contacts, 1, sides);
  ContactRows rows;
  set_contact_rows(surfaces, model, state, sides, {}, 1, rows);
  std::vector<Point3> sums(at(model.block_count()), Point3{0, 0, 0});
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    for (auto e = at(rows.start[c]); e < at(rows.start[c + 1]); ++e) {
      for (std::size_t k = 0; k < 9; ++k) {
        sums[at(rows.block[e])][k % 3] += rows.value[e][k] * impulse[3 * c + k / 3];
      }
    }
  }
  return sums;
}

MaterialPoint on_nodes(const std::array<std::int32_t, 3>& vertex,
                       const std::array<double, 3>& weight) {
  MaterialPoint point;
  point.vertex = vertex;
  point.weight = weight;
  return point;
}
MaterialPoint on_rigid(const Point3& local) {
  MaterialPoint point;
  point.local = local;
  return point;
}

std::int32_t add_frame(Model& model, const Point3& center) {
  const std::int32_t frame = add_rigid(model, 0, {0, 0, 0}, center);
  model.body_island.back() = -1;
  --model.island_count;
  prescribe(model, model.node_count + 2 * frame);
  prescribe(model, model.node_count + 2 * frame + 1);
  return frame;
}

void prescribe(Model& model, std::int32_t block) {
  model.prescribed[at(block)] = 1;
}

}  // namespace tetwarp::test
