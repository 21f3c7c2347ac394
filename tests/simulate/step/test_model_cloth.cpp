#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {
namespace {

using Cells = std::array<std::int64_t, 2>;

/// The triangles of a sheet without its squares, inner points moved in the plane.
Body triangle_body(const Cells& cells, double jitter) {
  const Scene sheet = scene_of({sheet_body("cloth", {1, 1}, cells)}, 0.01);
  const SceneGeometry geometry = make_scene_geometry(sheet);
  Surface surface = geometry.bodies[0].surface;
  for (std::size_t n = 0; n < surface.points.size(); ++n) {
    Point3& x = surface.points[n];
    const bool is_inner = x[0] > 1e-9 && x[0] < 1 - 1e-9 && x[1] > 1e-9 && x[1] < 1 - 1e-9;
    const double step = is_inner ? jitter / static_cast<double>(cells[0]) : 0;
    x[0] += step * std::sin(12.9898 * static_cast<double>(n));
    x[1] += step * std::cos(78.233 * static_cast<double>(n));
  }
  Body body = sheet_body("cloth", {1, 1}, cells);
  body.geometry = surface;
  return body;
}

/// Energy of the edges of a model whose points a map has moved.
double stretch_energy(const Model& model, const std::function<Point3(const Point3&)>& map) {
  double energy = 0;
  for (std::size_t e = 0; e < model.edges.nodes.size(); ++e) {
    const auto [a, b] = model.edges.nodes[e];
    const double stretch =
        distance_of(map(at(model.start.position, a)), map(at(model.start.position, b))) -
        model.edges.rest_length[e];
    energy += model.edges.stiffness[e] * stretch * stretch / 2;
  }
  return energy;
}

/// Energy of bending for heights z(x).
double bend_energy(const Model& model, const std::function<double(const Point3&)>& height) {
  double energy = 0;
  for (std::size_t k = 0; k < model.scalar_blocks.nodes.size(); ++k) {
    const auto [i, j] = model.scalar_blocks.nodes[k];
    energy += model.scalar_blocks.bend[k] * height(at(model.start.position, i)) *
              height(at(model.start.position, j)) / 2;
  }
  return energy;
}

Point3 stretched(const Point3& x) {
  return {1.01 * x[0], x[1], x[2]};
}
Point3 sheared(const Point3& x) {
  return {x[0] + 1e-4 * x[1], x[1], x[2]};
}

/// E h e^2 / 2 and S g^2 / 2 per area, also for cells that are not square.
TEST(SheetCloth, StoresStretchAndShearPerArea) {
  for (const Cells& cells : {Cells{4, 4}, Cells{16, 16}, Cells{12, 5}}) {
    Body body = sheet_body("cloth", {1, 1}, cells);
    body.cloth = {.areal_density = 0.3, .stretch = 400, .shear = 0, .bend = 0};
    const Model stretch = model_of(scene_of({body}, 0.01));
    body.cloth = {.areal_density = 0.3, .stretch = 0, .shear = 80, .bend = 0};
    const Model shear = model_of(scene_of({body}, 0.01));

    EXPECT_NEAR(stretch_energy(stretch, stretched) / (200 * 1e-4), 1, 1e-10);
    EXPECT_NEAR(stretch_energy(shear, sheared) / (40 * 1e-8), 1, 1e-3);
    EXPECT_NEAR(total(shear.node_mass), 0.3, 1e-13);
  }
}

/// B c^2 / 2 per area, over the nodes that have neighbors on both sides.
TEST(SheetCloth, StoresBendingPerArea) {
  for (const std::int64_t n : {5, 20}) {
    Body body = sheet_body("cloth", {1, 1}, {n, n});
    body.cloth.bend = 2e-4;
    const Model model = model_of(scene_of({body}, 0.01));
    const double bent = bend_energy(model, [](const Point3& x) { return 0.1 * x[0] * x[0]; });
    const double inner = 1 - 1 / static_cast<double>(n);

    EXPECT_NEAR(bent / (1e-4 * 0.04 * inner), 1, 1e-9);
    EXPECT_NEAR(bend_energy(model, [](const Point3& x) { return 1 + 2 * x[0] + 3 * x[1]; }), 0,
                1e-12);
  }
}

/// Triangle meshes: the same energies for coarse and fine meshes. Springs depend on the directions
/// of edges: stretch is 1.25 E h of right triangles, 9/8 E h of edges in all directions.
TEST(TriangleCloth, DoesNotDependOnTheMesh) {
  const auto energies = [](const Cells& cells, double jitter) {
    Body body = triangle_body(cells, jitter);
    body.cloth = {.areal_density = 0.3, .stretch = 400, .shear = 0, .bend = 2e-4};
    const Model model = model_of(scene_of({body}, 0.01));
    EXPECT_NEAR(total(model.node_mass), 0.3, 1e-12);
    EXPECT_NEAR(bend_energy(model, [](const Point3& x) { return 1 + 2 * x[0] + 3 * x[1]; }), 0,
                1e-12);
    return std::array{stretch_energy(model, stretched),
                      bend_energy(model, [](const Point3& x) { return 0.1 * x[0] * x[0]; })};
  };
  const auto coarse = energies({12, 12}, 0), fine = energies({24, 24}, 0);
  const auto irregular = energies({24, 24}, 0.2);

  EXPECT_NEAR(fine[0] / coarse[0], 1, 1e-10);
  EXPECT_NEAR(fine[0] / (200 * 1e-4), 1.25, 0.01);
  EXPECT_NEAR(irregular[0] / fine[0], 1, 0.1);
  EXPECT_NEAR(fine[1], 1e-4 * 0.04 * std::pow(1 - 1.0 / 24, 2), 0.01 * 4e-6);
  EXPECT_NEAR(irregular[1] / fine[1], 1, 0.2);
}

}  // namespace
}  // namespace tetwarp::test
