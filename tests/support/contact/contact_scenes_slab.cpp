/// @file contact_scenes_slab.cpp
/// The elastic slab: linear tetrahedra, lumped masses, implicit Euler.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/base/counter_hash.hpp"
#include "host/base/point3.hpp"
#include "tests/support/contact/contact_scenes.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::scenes {
namespace {
/// Gradients of the four barycentric coordinates; the volume.
struct Element {
  std::array<Point3, 4> gradient;
  double volume;
};

Element element_of(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  const Point3 x = minus(b, a), y = minus(c, a), z = minus(d, a);
  const double six = dot(x, cross(y, z));
  Element element;
  element.gradient[1] = cross(y, z);
  element.gradient[2] = cross(z, x);
  element.gradient[3] = cross(x, y);
  element.gradient[0] = {0, 0, 0};
  for (std::size_t k = 1; k < 4; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      element.gradient[k][i] /= six;
      element.gradient[0][i] -= element.gradient[k][i];
    }
  }
  element.volume = std::abs(six) / 6;
  return element;
}
}  // namespace

ContactProblem elastic_slab(const ElasticSlab& choice) {
  const double h = choice.edge;
  const Mesh mesh =
      lattice({static_cast<int>(choice.cubes[0]), static_cast<int>(choice.cubes[1]),
               static_cast<int>(choice.cubes[2])},
              {0, 0, 0},
              {h * static_cast<double>(choice.cubes[0]), h * static_cast<double>(choice.cubes[1]),
               h * static_cast<double>(choice.cubes[2])});
  const double shear = choice.young / (2 * (1 + choice.poisson));
  const double lame =
      choice.young * choice.poisson / ((1 + choice.poisson) * (1 - 2 * choice.poisson));
  const double dt = choice.time_step;

  // A = M + dt^2 K; the block of K between nodes p and q of a tetrahedron is
  // volume (lame g_p g_q^T + shear (g_q g_p^T + g_p . g_q I)).
  const auto dofs = static_cast<std::int64_t>(3 * mesh.rest_positions.size());
  std::vector<Entry> entries;
  std::vector<double> mass(mesh.rest_positions.size(), 0.0);
  for (const auto& tet : mesh.tets) {
    const auto node = [&](std::size_t k) { return static_cast<std::size_t>(tet[k]); };
    const Element e = element_of(mesh.rest_positions[node(0)], mesh.rest_positions[node(1)],
                                 mesh.rest_positions[node(2)], mesh.rest_positions[node(3)]);
    for (std::size_t p = 0; p < 4; ++p) {
      mass[node(p)] += choice.density * e.volume / 4;
      for (std::size_t q = 0; q < 4; ++q) {
        const Point3& g = e.gradient[p];
        const Point3& f = e.gradient[q];
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            const double block =
                lame * g[i] * f[j] + shear * (f[i] * g[j] + (i == j ? dot(g, f) : 0.0));
            entries.push_back({static_cast<std::int64_t>(3 * node(p) + i),
                               static_cast<std::int64_t>(3 * node(q) + j),
                               dt * dt * e.volume * block});
          }
        }
      }
    }
  }
  ContactProblem problem;
  const double length = h * static_cast<double>(choice.cubes[0]);
  std::vector<std::int64_t> low;
  for (std::size_t v = 0; v < mass.size(); ++v) {
    const Point3& x = mesh.rest_positions[v];
    for (std::int64_t i = 0; i < 3; ++i) {
      const auto dof = static_cast<std::int64_t>(3 * v) + i;
      entries.push_back({dof, dof, mass[v]});
    }
    // Pressed down at one end, lifted at the other, pushed sideways all over.
    const double lift = 60 * (x[0] / length - 0.5);
    problem.load.insert(problem.load.end(),
                        {mass[v] * dt * 4, mass[v] * dt * 1, mass[v] * dt * (lift - 9.81)});
    if (x[2] == 0) low.push_back(static_cast<std::int64_t>(v));
  }
  problem.system = sparse_matrix(dofs, dofs, std::move(entries));

  std::vector<Entry> rows;
  const auto available = static_cast<std::int64_t>(low.size());
  const std::int64_t contacts = std::min(choice.contacts, available);
  for (std::int64_t c = 0; c < contacts; ++c) {
    const std::int64_t node = low[static_cast<std::size_t>(c * available / contacts)];
    rows.push_back({3 * c, 3 * node + 2, 1});
    rows.push_back({3 * c + 1, 3 * node, 1});
    rows.push_back({3 * c + 2, 3 * node + 1, 1});
    const double bump = unit_of((std::uint64_t{choice.seed} << 32) + static_cast<std::uint64_t>(c));
    problem.velocity_offset.insert(problem.velocity_offset.end(), {1e-4 * (bump - 0.3) / dt, 0, 0});
    problem.friction.push_back(choice.friction);
  }
  problem.jacobian = sparse_matrix(3 * contacts, dofs, std::move(rows));
  add_glue(problem, choice.glue, dt, h * h, choice.seed + 1);
  return problem;
}

}  // namespace tetwarp::scenes
