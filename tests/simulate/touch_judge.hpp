/// @file touch_judge.hpp
/// Whether the surfaces of a simulation are apart, by a test of all pairs of triangles.
#pragma once
#include "host/simulate/model/motion.hpp"
#include "host/simulate/model/rotations.hpp"
#include "tests/oracles/triangle_intersection.hpp"
#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {

/// Looks at a simulator after each of its steps: at the end of the step and at 15 instants within,
/// between which points move straight. Obstacles stand where their paths are.
class Judge {
 public:
  explicit Judge(Simulator& simulator) : simulator_(simulator) {
    const Scene& scene = simulator.scene();
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      triangles_.push_back(simulator.body(b).surface.triangles);
      touches_itself_.push_back(
          scene.bodies[b].self.value_or(scene.bodies[b].kind == BodyKind::cloth));
    }
    for (const Obstacle& obstacle : scene.obstacles) {
      const auto* surface = std::get_if<Surface>(&obstacle.geometry);
      triangles_.push_back(surface == nullptr ? Triangles{} : surface->triangles);
      touches_itself_.push_back(false);
    }
    before_ = places_now();
  }

  void expect_apart() {
    const Places after = places_now();
    const int parts = simulator_.record().substeps == 1 ? 16 : 1;
    for (int instant = 1; instant <= parts; ++instant) {
      const double share = static_cast<double>(instant) / parts;
      EXPECT_EQ(intersections_at(after, share), 0)
          << "step " << simulator_.step_index() << ", instant " << instant;
    }
    before_ = after;
  }

 private:
  using Triangles = std::vector<std::array<std::int32_t, 3>>;
  using Places = std::vector<std::vector<Point3>>;

  struct Box {
    Point3 low, high;
    bool meets(const Box& other) const {
      for (std::size_t d = 0; d < 3; ++d) {
        if (low[d] > other.high[d] || other.low[d] > high[d]) return false;
      }
      return true;
    }
  };
  static Box box_of(const std::vector<Point3>& points) {
    Box box{points.front(), points.front()};
    for (const Point3& x : points) {
      for (std::size_t d = 0; d < 3; ++d) {
        box.low[d] = std::min(box.low[d], x[d]);
        box.high[d] = std::max(box.high[d], x[d]);
      }
    }
    return box;
  }

  Places places_now() const {
    const Scene& scene = simulator_.scene();
    Places places;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      places.push_back(simulator_.surface_positions(b));
    }
    for (const Obstacle& obstacle : scene.obstacles) {
      places.emplace_back();
      const auto* surface = std::get_if<Surface>(&obstacle.geometry);
      if (surface == nullptr) continue;
      const PathPlace place = place_at(obstacle.path, simulator_.time()).value_or(PathPlace{});
      for (const Point3& x : surface->points) places.back().push_back(plus(x, place.displacement));
    }
    return places;
  }

  /// Points of bodies within obstacles without triangles.
  int points_inside(const std::vector<Point3>& points) const {
    int count = 0;
    for (const Obstacle& obstacle : simulator_.scene().obstacles) {
      for (const Point3& x : points) {
        if (const auto* plane = std::get_if<PlaneObstacle>(&obstacle.geometry)) {
          count += dot(plane->normal, minus(x, plane->point)) <= 0;
        } else if (const auto* bar = std::get_if<CapsuleObstacle>(&obstacle.geometry)) {
          const Point3 axis = minus(bar->to, bar->from), from = minus(x, bar->from);
          const double t = std::clamp(dot(from, axis) / dot(axis, axis), 0.0, 1.0);
          count += norm(minus(from, times(t, axis))) <= bar->radius;
        }
      }
    }
    return count;
  }

  int intersections_at(const Places& after, double share) const {
    Places now = after;
    std::vector<std::vector<Box>> boxes(now.size());
    std::vector<Box> whole(now.size());
    int count = 0;
    for (std::size_t b = 0; b < now.size(); ++b) {
      if (now[b].empty()) continue;
      for (std::size_t i = 0; i < now[b].size(); ++i) {
        now[b][i] = plus(times(1 - share, before_[b][i]), times(share, after[b][i]));
      }
      whole[b] = box_of(now[b]);
      for (const auto& t : triangles_[b]) {
        boxes[b].push_back(box_of({at(now[b], t[0]), at(now[b], t[1]), at(now[b], t[2])}));
      }
      if (b < simulator_.scene().bodies.size()) count += points_inside(now[b]);
    }
    for (std::size_t a = 0; a < now.size(); ++a) {
      for (std::size_t b = a; b < now.size(); ++b) {
        if (now[a].empty() || now[b].empty() || (a == b && !touches_itself_[a])) continue;
        if (whole[a].meets(whole[b])) count += crossings(now, boxes, a, b);
      }
    }
    return count;
  }

  int crossings(const Places& now,
                const std::vector<std::vector<Box>>& boxes,
                std::size_t a,
                std::size_t b) const {
    int count = 0;
    for (std::size_t s = 0; s < triangles_[a].size(); ++s) {
      for (std::size_t t = a == b ? s + 1 : 0; t < triangles_[b].size(); ++t) {
        if (!boxes[a][s].meets(boxes[b][t])) continue;
        const auto &first = triangles_[a][s], &second = triangles_[b][t];
        const bool share_a_corner =
            a == b && std::find_first_of(first.begin(), first.end(), second.begin(),
                                         second.end()) != first.end();
        if (share_a_corner) continue;
        count += reference::triangles_intersect(
            {at(now[a], first[0]), at(now[a], first[1]), at(now[a], first[2])},
            {at(now[b], second[0]), at(now[b], second[1]), at(now[b], second[2])});
      }
    }
    return count;
  }

  Simulator& simulator_;
  std::vector<Triangles> triangles_;  ///< [bodies, then obstacles]
  std::vector<bool> touches_itself_;
  Places before_;
};

}  // namespace tetwarp::test
