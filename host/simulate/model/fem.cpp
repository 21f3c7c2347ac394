/// @file fem.cpp
/// Gradients, volumes and mass matrices of tetrahedra.
#include "host/simulate/model/fem.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/base/point3.hpp"
#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/scalar_entries.hpp"
#include "host/simulate/model/tet_materials.hpp"

namespace tetwarp {
namespace {

/// Gradients and volumes of the body's tetrahedra at rest.
void add_elements(const BodyPart& part, Model& model) {
  const auto fail = [&](std::size_t t, const std::string& what) {
    throw std::invalid_argument(error_prefix(part) + "tetrahedron " + std::to_string(t) + " is " +
                                what +
                                " at rest; give a mesh whose tetrahedra have a "
                                "volume");
  };
  for (std::size_t t = 0; t < part.geometry.tets.size(); ++t) {
    std::array<std::int32_t, 4> nodes = part.geometry.tets[t];
    std::array<Point3, 4> x;
    for (std::size_t a = 0; a < 4; ++a) {
      x[a] = at(part.geometry.nodes, nodes[a]);
      nodes[a] += part.first_node;
    }
    const std::array<Point3, 3> edge{minus(x[1], x[0]), minus(x[2], x[0]), minus(x[3], x[0])};
    const double six_volumes = dot(edge[0], cross(edge[1], edge[2]));
    double longest = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < a; ++b) longest = std::max(longest, norm(minus(x[a], x[b])));
    }
    // Rounding of positions and products alone gives volumes of this size.
    const double rounding = 1e-14 * longest * longest * longest;
    if (!(std::fabs(six_volumes) > rounding)) fail(t, "flat");
    if (six_volumes < 0) fail(t, "inverted");
    std::array<double, 9> gradient;
    for (std::size_t a = 0; a < 3; ++a) {
      const Point3 normal = cross(edge[(a + 1) % 3], edge[(a + 2) % 3]);
      for (std::size_t d = 0; d < 3; ++d) gradient[3 * a + d] = normal[d] / six_volumes;
    }
    model.tets.nodes.push_back(nodes);
    model.tets.gradient.push_back(gradient);
    model.tets.volume.push_back(six_volumes / 6);
    model.tets.gamma.push_back(part.body.damping.gamma);
  }
}

double entry_of(const TetMass& mass, std::size_t a, std::size_t b) {
  constexpr std::array<std::array<std::size_t, 4>, 4> place{
      {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}}};
  return mass[place[a][b]];
}

/// Scalar blocks of the body's nodes, gathered row by row, and the row sums. Lumped: the row sums
/// on the diagonal.
void add_masses(const BodyPart& part,
                const std::vector<TetMass>& masses,
                std::size_t first_tet,
                Model& model) {
  const std::size_t node_count = part.geometry.nodes.size();
  const auto& tets = part.geometry.tets;
  std::vector<std::int64_t> first(node_count + 1, 0);
  for (const auto& tet : tets) {
    for (const std::int32_t node : tet) ++first[static_cast<std::size_t>(node) + 1];
  }
  for (std::size_t n = 0; n < node_count; ++n) first[n + 1] += first[n];
  std::vector<std::int64_t> next(first.begin(), first.end() - 1);
  std::vector<std::int32_t> corners(4 * tets.size());  // 4 tet + corner, by node
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t a = 0; a < 4; ++a) {
      corners[static_cast<std::size_t>(next[static_cast<std::size_t>(tets[t][a])]++)] =
          static_cast<std::int32_t>(4 * t + a);
    }
  }

  std::vector<ScalarEntry> row;
  double stiffest = 0;
  for (std::size_t n = 0; n < node_count; ++n) {
    row.clear();
    double sum = 0, stiffness = 0;
    for (std::int64_t i = first[n]; i < first[n + 1]; ++i) {
      const auto corner = static_cast<std::size_t>(corners[static_cast<std::size_t>(i)]);
      const std::size_t t = corner / 4, a = corner % 4;
      stiffness += model.tets.mu[first_tet + t];
      for (std::size_t b = 0; b < 4; ++b) {
        const double mass = entry_of(masses[t], a, b);
        sum += mass;
        row.push_back({static_cast<std::int32_t>(n), tets[t][b], mass, 0});
      }
    }
    stiffest = std::max(stiffest, stiffness);
    if (!(sum > 0) && !(stiffness > 0)) {
      throw std::invalid_argument(
          error_prefix(part) + "node " + std::to_string(n) +
          " has neither mass nor stiffness: all around it is void; raise the threshold or give its "
          "values a density in the transfer table");
    }
    if (part.body.mass == MassKind::lumped) {
      row.assign(1, {static_cast<std::int32_t>(n), static_cast<std::int32_t>(n), sum, 0});
    }
    for (ScalarEntry& entry : row) {
      entry.row += part.first_node;
      entry.column += part.first_node;
    }
    add_scalar_entries(row, part.body.damping, model);
    model.node_mass[static_cast<std::size_t>(part.first_node) + n] = sum;
  }
}

}  // namespace

void add_fem(const BodyPart& part, ImageMaterialsOfBodies& images, Model& model) {
  const std::size_t first_tet = model.tets.nodes.size();
  add_elements(part, model);
  TetMaterials materials;
  if (std::holds_alternative<ImageGeometry>(part.body.geometry)) {
    const ImageMaterials& image = images.of(part, model.tets, first_tet);
    materials = image.tets;
    model.body_foreground[static_cast<std::size_t>(part.index)] = image.foreground;
    model.body_covered[static_cast<std::size_t>(part.index)] = image.covered;
  } else {
    materials = uniform_materials(part, model.tets, first_tet);
  }
  model.tets.lambda.insert(model.tets.lambda.end(), materials.lambda.begin(),
                           materials.lambda.end());
  model.tets.mu.insert(model.tets.mu.end(), materials.mu.begin(), materials.mu.end());
  add_masses(part, materials.mass, first_tet, model);
  double mass = 0;
  for (std::size_t n = 0; n < part.geometry.nodes.size(); ++n) {
    mass += model.node_mass[static_cast<std::size_t>(part.first_node) + n];
  }
  if (!(mass > 0) || !std::isfinite(mass)) {
    throw std::invalid_argument(error_prefix(part) + "its mass is " + std::to_string(mass) +
                                " kg; give its values a density, or raise the threshold");
  }
}

}  // namespace tetwarp
