#include "bench/collide/sort_and_sweep.hpp"

#include <algorithm>
#include <vector>

#include "kernels/collide/vertex_box.hpp"

namespace tetwarp::bench {
namespace {
struct BodyBox {
  Box box;
  std::int32_t body;
};

View<const double> numbers(const std::vector<Point3>& points) {
  return {points[0].data(), static_cast<std::int64_t>(3 * points.size())};
}
View<const double> numbers(const std::vector<double>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}

std::vector<BodyBox> boxes_of(const test::CollideScene& scene) {
  const CollisionSurfaces& s = scene.surfaces;
  const auto vertices = static_cast<std::int32_t>(s.vertex_body.size());
  std::vector<Box> boxes(s.vertex_body.size());
  const VertexRun run{0, vertices, 0};
  RunBox all;
  VertexBoxOp body{};
  body.runs = {&run, 1};
  body.motion.start = numbers(scene.motion.start.vertices);
  body.motion.end = numbers(scene.motion.end.vertices);
  body.motion.sagitta = numbers(scene.motion.sagitta);
  body.radius = numbers(s.vertex_radius);
  body.found_half_distance = found_thicknesses * s.thickness / 2;
  body.fraction = found_fraction;
  body.finds = 1;
  body.found = {boxes.data(), vertices};
  body.run_boxes = {&all, 1};
  body(0);
  std::vector<BodyBox> triangles;
  for (const auto& corner : s.triangles) {
    Box box = boxes[static_cast<std::size_t>(corner[0])];
    add_box(box, boxes[static_cast<std::size_t>(corner[1])]);
    add_box(box, boxes[static_cast<std::size_t>(corner[2])]);
    triangles.push_back({box, s.vertex_body[static_cast<std::size_t>(corner[0])]});
  }
  return triangles;
}
}  // namespace

std::int64_t sort_and_sweep(const test::CollideScene& scene) {
  const bool same_body_counts = scene.surfaces.bodies[0].touches_itself;
  std::vector<BodyBox> boxes = boxes_of(scene);
  std::sort(boxes.begin(), boxes.end(),
            [](const BodyBox& a, const BodyBox& b) { return a.box.low[0] < b.box.low[0]; });
  std::int64_t pairs = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const BodyBox& own = boxes[i];
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      const BodyBox& other = boxes[j];
      if (other.box.low[0] > own.box.high[0]) break;
      if (other.body == own.body && !same_body_counts) continue;
      pairs += overlap(own.box, other.box);
    }
  }
  return pairs;
}

}  // namespace tetwarp::bench
