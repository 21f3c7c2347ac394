/// @file scene_loads.cpp
/// Finds the points that loads act on, and sums their forces.
#include "host/simulate/step/scene_loads.hpp"

#include <stdexcept>

#include "host/simulate/model/body_points.hpp"
#include "host/simulate/model/motion.hpp"
#include "host/simulate/model/rotations.hpp"

namespace tetwarp {
namespace {

std::size_t body_named(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].name == name) return b;
  }
  throw std::invalid_argument("loads: there is no body '" + name + "'");
}

}  // namespace

SceneLoads::SceneLoads(const Scene& scene, const SceneGeometry& geometry, const Model& model)
    : scene_(scene), model_(model) {
  for (std::size_t l = 0; l < scene.loads.size(); ++l) {
    const std::size_t b = body_named(scene, scene.loads[l].body);
    const auto body = static_cast<std::int32_t>(b);
    const BodyGeometry& of = geometry.bodies[b];
    const auto& selected = geometry.load_nodes[l];
    Place place;
    if (!scene.loads[l].pressure) {
      for (const std::int32_t i : selected) {
        place.points.push_back(selected_point(model, geometry, body, i));
      }
      place.shares = shares_of(of, selected);
    } else {
      const std::vector<ModelPoint> all = bound_surface(model, geometry, body);
      std::vector<std::int32_t> number(all.size(), -1);
      for (const std::int32_t i : selected) {
        number[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(place.points.size());
        place.points.push_back(at(all, i));
      }
      for (const auto& triangle : of.surface.triangles) {
        const std::array<std::int32_t, 3> corners{at(number, triangle[0]), at(number, triangle[1]),
                                                  at(number, triangle[2])};
        if (corners[0] >= 0 && corners[1] >= 0 && corners[2] >= 0) {
          place.triangles.push_back(corners);
        }
      }
      if (place.triangles.empty()) {
        throw std::invalid_argument("loads[" + std::to_string(l) +
                                    "].select: no triangle of the surface has all its points "
                                    "selected, so no pressure can act; select more");
      }
    }
    places_.push_back(std::move(place));
  }
}

void SceneLoads::add(const ModelPoint& point,
                     const Point3& force,
                     const ModelState& state,
                     std::vector<Point3>& forces) const {
  if (point.rigid >= 0) {
    const auto block = static_cast<std::size_t>(model_.node_count + 2 * point.rigid);
    const Point3 lever = rotate(at(state.rotation, point.rigid), point.local);
    forces[block] = plus(forces[block], force);
    forces[block + 1] = plus(forces[block + 1], cross(lever, force));
    return;
  }
  for (std::size_t a = 0; a < 4 && point.node[a] >= 0; ++a) {
    const auto block = static_cast<std::size_t>(point.node[a]);
    forces[block] = plus(forces[block], times(point.weight[a], force));
  }
}

void SceneLoads::add_places(StatePlaces& places) const {
  for (const Place& place : places_) {
    for (const ModelPoint& point : place.points) {
      if (point.rigid >= 0) {
        places.rigid.push_back(point.rigid);
      } else if (!place.triangles.empty()) {
        for (const std::int32_t n : point.node) {
          if (n >= 0) places.nodes.push_back(n);
        }
      }
    }
  }
}

void SceneLoads::forces(const ModelState& state,
                        double end_time,
                        std::vector<Point3>& forces) const {
  forces.assign(static_cast<std::size_t>(model_.block_count()), {0, 0, 0});
  for (std::size_t l = 0; l < places_.size(); ++l) {
    const Load& load = scene_.loads[l];
    // from < end_time <= to
    const bool is_over = has_come(end_time, load.to) && !has_come(load.to, end_time);
    if (has_come(load.from, end_time) || is_over) continue;
    const Place& place = places_[l];
    for (std::size_t p = 0; p < place.shares.size(); ++p) {
      add(place.points[p], times(place.shares[p], *load.force), state, forces);
    }
    for (const auto& triangle : place.triangles) {
      std::array<Point3, 3> x;
      for (std::size_t c = 0; c < 3; ++c) {
        x[c] = position_of(at(place.points, triangle[c]), state, model_.node_count);
      }
      const Point3 twice_area = cross(minus(x[1], x[0]), minus(x[2], x[0]));
      const Point3 third = times(-*load.pressure / 6, twice_area);
      for (const std::int32_t corner : triangle) {
        add(at(place.points, corner), third, state, forces);
      }
    }
  }
}

}  // namespace tetwarp
