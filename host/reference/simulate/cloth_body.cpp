/// @file cloth_body.cpp
/// Sheets of squares and triangle meshes as springs, and their forces.
#include "host/reference/simulate/cloth_body.hpp"

#include <algorithm>
#include <map>

namespace tetwarp::reference {
namespace {

/// Adds the energy 1/2 weight |sum_i c_i x_i|^2.
void add_square(const std::vector<int>& nodes,
                const std::vector<double>& coefficients,
                double weight,
                MatrixXd& bend) {
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    for (std::size_t b = 0; b < nodes.size(); ++b) {
      bend(nodes[a], nodes[b]) += weight * coefficients[a] * coefficients[b];
    }
  }
}

/// A sheet of m x n squares of dx x dy. Each node stands for the rectangle up to halfway to its
/// neighbors, each edge for the strip up to halfway to the next ones beside it: k = stretch w / L.
/// A shear by gamma lengthens a diagonal l by gamma dx dy / l, so that two of stiffness
/// shear l^2 / (2 dx dy) store shear gamma^2/2 per area.
void add_sheet(const Body& body, const BodyGeometry& geometry, ClothBody& cloth) {
  const std::array<int, 2> cells{static_cast<int>(geometry.sheet_cells[0]),
                                 static_cast<int>(geometry.sheet_cells[1])};
  const auto node = [&](int u, int v) { return u + (cells[0] + 1) * v; };
  const auto length_of = [&](int a, int b) {
    return (vector_of(geometry.nodes[static_cast<std::size_t>(a)]) -
            vector_of(geometry.nodes[static_cast<std::size_t>(b)]))
        .norm();
  };
  const auto add_spring = [&](int a, int b, double stiffness) {
    cloth.springs.push_back({{a, b}, stiffness, length_of(a, b), body.damping.gamma});
  };
  const double dx = length_of(node(0, 0), node(1, 0)), dy = length_of(node(0, 0), node(0, 1));
  for (int v = 0; v <= cells[1]; ++v) {
    const double height = v == 0 || v == cells[1] ? dy / 2 : dy;
    for (int u = 0; u <= cells[0]; ++u) {
      const double width = u == 0 || u == cells[0] ? dx / 2 : dx;
      cloth.mass(node(u, v), node(u, v)) = body.cloth.areal_density * width * height;
      if (u < cells[0]) add_spring(node(u, v), node(u + 1, v), body.cloth.stretch * height / dx);
      if (v < cells[1]) add_spring(node(u, v), node(u, v + 1), body.cloth.stretch * width / dy);
      if (u + 1 < cells[0]) {
        add_square({node(u, v), node(u + 1, v), node(u + 2, v)}, {1, -2, 1},
                   body.cloth.bend * height / (dx * dx * dx), cloth.bend);
      }
      if (v + 1 < cells[1]) {
        add_square({node(u, v), node(u, v + 1), node(u, v + 2)}, {1, -2, 1},
                   body.cloth.bend * width / (dy * dy * dy), cloth.bend);
      }
      if (u == cells[0] || v == cells[1]) continue;
      const double diagonal = body.cloth.shear * (dx * dx + dy * dy) / (2 * dx * dy);
      add_spring(node(u, v), node(u + 1, v + 1), diagonal);
      add_spring(node(u + 1, v), node(u, v + 1), diagonal);
    }
  }
}

/// Any triangle mesh. An edge of length L with triangles of area A beside it carries a strip of
/// width A / L. The other diagonal, of length l, of an inner edge's quad resists shear: springs k
/// of all directions store k l^2/16 gamma^2, a third of it for each of a triangle's three edges.
/// Bending is B/2 |sum_j (cot + cot)/2 (x_j - x_i)|^2 / A_i, summed over the inner nodes.
void add_triangles(const Body& body, const BodyGeometry& geometry, ClothBody& cloth) {
  const auto count = static_cast<Eigen::Index>(geometry.nodes.size());
  const auto rest = [&](int n) { return vector_of(geometry.nodes[static_cast<std::size_t>(n)]); };
  MatrixXd laplacian = MatrixXd::Zero(count, count);
  VectorXd node_area = VectorXd::Zero(count);
  std::map<std::array<int, 2>, std::vector<int>> opposites;  // of the edges
  std::map<std::array<int, 2>, double> edge_area;
  for (const auto& triangle : geometry.cloth_triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = triangle[c], b = triangle[(c + 1) % 3], apex = triangle[(c + 2) % 3];
      const Vector3d to_a = rest(a) - rest(apex), to_b = rest(b) - rest(apex);
      const double area = to_a.cross(to_b).norm() / 2;
      const double half_cotangent = to_a.dot(to_b) / (4 * area);
      for (const auto& [i, j] : {std::array{a, b}, std::array{b, a}}) {
        laplacian(i, j) += half_cotangent;
        laplacian(i, i) -= half_cotangent;
      }
      node_area(apex) += area / 3;
      const std::array edge{std::min(a, b), std::max(a, b)};
      opposites[edge].push_back(apex);
      edge_area[edge] += area;
    }
  }
  std::vector<bool> is_border(geometry.nodes.size());
  for (const auto& [edge, apexes] : opposites) {
    const double area = edge_area[edge];
    const double length = (rest(edge[0]) - rest(edge[1])).norm();
    cloth.springs.push_back(
        {edge, body.cloth.stretch * area / (length * length), length, body.damping.gamma});
    if (apexes.size() == 2) {
      const double across = (rest(apexes[0]) - rest(apexes[1])).norm();
      cloth.springs.push_back({{apexes[0], apexes[1]},
                               body.cloth.shear * 8 * area / (3 * across * across),
                               across,
                               body.damping.gamma});
    } else {
      for (const int n : edge) is_border[static_cast<std::size_t>(n)] = true;
    }
  }
  for (int n = 0; n < count; ++n) {
    cloth.mass(n, n) = body.cloth.areal_density * node_area(n);
    if (is_border[static_cast<std::size_t>(n)]) continue;
    cloth.bend += body.cloth.bend / node_area(n) * laplacian.row(n).transpose() * laplacian.row(n);
  }
}

}  // namespace

ClothBody cloth_body(const Body& body, const BodyGeometry& geometry) {
  const auto count = static_cast<Eigen::Index>(geometry.nodes.size());
  ClothBody cloth{{}, MatrixXd::Zero(count, count), MatrixXd::Zero(count, count)};
  if (geometry.sheet_cells[0] > 0) {
    add_sheet(body, geometry, cloth);
  } else {
    add_triangles(body, geometry, cloth);
  }
  return cloth;
}

Vector3d spring_force(const EdgeSpring& spring, const Vector3d& line) {
  const double length = line.norm();
  if (length == 0) return Vector3d::Zero();
  return -spring.stiffness * (length - spring.rest_length) / length * line;
}

Matrix3d spring_stiffness(const EdgeSpring& spring, const Vector3d& line) {
  const double length = line.norm();
  if (length == 0) return spring.stiffness * Matrix3d::Identity();
  const Matrix3d along = line * line.transpose() / (length * length);
  const double across = std::max(1 - spring.rest_length / length, 0.0);
  return spring.stiffness * (across * (Matrix3d::Identity() - along) + along);
}

}  // namespace tetwarp::reference
