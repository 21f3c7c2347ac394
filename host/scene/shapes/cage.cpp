/// @file cage.cpp
/// Solves Laplace's equation on the lattice for the weights of each point.
#include "host/scene/shapes/cage.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host/base/five_tets.hpp"
#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
using Sparse = Eigen::SparseMatrix<double>;
using Index3 = std::array<std::int64_t, 3>;

/// Numbers of lattice nodes, first axis fastest.
struct NodeIndex {
  Index3 counts;

  std::int64_t size() const { return counts[0] * counts[1] * counts[2]; }
  std::int64_t number_of(const Index3& node) const {
    return (node[2] * counts[1] + node[1]) * counts[0] + node[0];
  }
  Index3 node_of(std::int64_t number) const {
    return {number % counts[0], number / counts[0] % counts[1], number / counts[0] / counts[1]};
  }
  bool is_outer(const Index3& node) const {
    for (std::size_t d = 0; d < 3; ++d) {
      if (node[d] == 0 || node[d] == counts[d] - 1) return true;
    }
    return false;
  }
};

NodeIndex nodes_of(const LatticeFrame& frame) {
  return {{frame.cells[0] + 1, frame.cells[1] + 1, frame.cells[2] + 1}};
}

/// Integrals of products of gradients, as triplets (row, column, value).
std::vector<Eigen::Triplet<double>> laplacian(const TetMesh& mesh) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(16 * mesh.tets.size());
  for (const auto& tet : mesh.tets) {
    const Point3& origin = at(mesh.nodes, tet[0]);
    const Point3 b = minus(at(mesh.nodes, tet[1]), origin);
    const Point3 c = minus(at(mesh.nodes, tet[2]), origin);
    const Point3 d = minus(at(mesh.nodes, tet[3]), origin);
    const double six_volumes = dot(b, cross(c, d));
    std::array<Point3, 4> gradient{Point3{}, times(1 / six_volumes, cross(c, d)),
                                   times(1 / six_volumes, cross(d, b)),
                                   times(1 / six_volumes, cross(b, c))};
    gradient[0] = times(-1.0, plus(plus(gradient[1], gradient[2]), gradient[3]));
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        entries.emplace_back(tet[i], tet[j], six_volumes / 6 * dot(gradient[i], gradient[j]));
      }
    }
  }
  return entries;
}

/// Weights of the cage's vertices at the nodes of the fine lattice, [vertex] rows.
class HarmonicWeights {
 public:
  HarmonicWeights(const LatticeFrame& coarse, const LatticeFrame& fine)
      : coarse_(coarse), fine_(fine), nodes_(nodes_of(fine)) {
    equation_.resize(static_cast<std::size_t>(nodes_.size()));
    for (std::int64_t n = 0; n < nodes_.size(); ++n) {
      equation_[static_cast<std::size_t>(n)] = nodes_.is_outer(nodes_.node_of(n)) ? -1 : count_++;
    }
    const auto entries = laplacian(make_lattice(fine));
    std::vector<Eigen::Triplet<double>> inner, coupling;
    for (const auto& entry : entries) {
      const std::int32_t row = at(equation_, entry.row()), column = at(equation_, entry.col());
      if (row < 0) continue;
      if (column >= 0) inner.emplace_back(row, column, entry.value());
      if (column < 0) coupling.emplace_back(row, entry.col(), entry.value());
    }
    inner_.resize(count_, count_);
    inner_.setFromTriplets(inner.begin(), inner.end());
    coupling_.resize(count_, static_cast<Eigen::Index>(nodes_.size()));
    coupling_.setFromTriplets(coupling.begin(), coupling.end());
    solver_.setTolerance(1e-15);
    if (count_ > 0) solver_.compute(inner_);
  }

  /// At all nodes, of one vertex.
  Eigen::VectorXd of(const Index3& vertex) const {
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nodes_.size()));
    for (std::int64_t n = 0; n < nodes_.size(); ++n) {
      if (at(equation_, static_cast<std::int32_t>(n)) < 0) {
        weight[n] = face_weight(nodes_.node_of(n), vertex);
      }
    }
    if (count_ == 0) return weight;
    const Eigen::VectorXd inner = solver_.solve(-(coupling_ * weight));
    for (std::int64_t n = 0; n < nodes_.size(); ++n) {
      const std::int32_t row = at(equation_, static_cast<std::int32_t>(n));
      if (row >= 0) weight[n] = inner[row];
    }
    return weight;
  }

 private:
  /// The bilinear weight of a vertex at an outer node.
  double face_weight(const Index3& node, const Index3& vertex) const {
    double weight = 1;
    for (std::size_t d = 0; d < 3; ++d) {
      const std::int64_t parts = fine_.cells[d] / coarse_.cells[d];
      const std::int64_t apart = std::abs(node[d] - parts * vertex[d]);
      if (apart >= parts) return 0;
      weight *= 1 - static_cast<double>(apart) / static_cast<double>(parts);
    }
    return weight;
  }

  LatticeFrame coarse_, fine_;
  NodeIndex nodes_;
  std::int32_t count_ = 0;              ///< inner nodes
  std::vector<std::int32_t> equation_;  ///< of each node, -1: outer
  Sparse inner_, coupling_;
  Eigen::ConjugateGradient<Sparse, Eigen::Lower | Eigen::Upper> solver_;
};

/// A point as weights of four nodes of a lattice.
struct LatticePoint {
  std::array<std::int64_t, 4> node{};
  std::array<double, 4> weight{};
};

LatticePoint located(const LatticeFrame& frame, const Point3& point) {
  const NodeIndex nodes = nodes_of(frame);
  Index3 cell{};
  Point3 part{};
  for (std::size_t d = 0; d < 3; ++d) {
    const double place = std::clamp((point[d] - frame.start[d]) / frame.edge[d], 0.0,
                                    static_cast<double>(frame.cells[d]));
    cell[d] = std::min(static_cast<std::int64_t>(place), frame.cells[d] - 1);
    part[d] = place - static_cast<double>(cell[d]);
  }
  const auto corner_at = [](int corner) {
    return Point3{double(corner & 1), double(corner >> 1 & 1), double(corner >> 2)};
  };
  LatticePoint best;
  double best_least = -1;
  for (const auto& corners : tets_of_cell[(cell[0] + cell[1] + cell[2]) % 2]) {
    const Point3 a = corner_at(corners[0]), b = corner_at(corners[1]), c = corner_at(corners[2]),
                 d = corner_at(corners[3]);
    const double whole = tet_volume(a, b, c, d);
    const std::array<double, 4> weight{
        tet_volume(part, b, c, d) / whole, tet_volume(a, part, c, d) / whole,
        tet_volume(a, b, part, d) / whole, tet_volume(a, b, c, part) / whole};
    const double least = *std::min_element(weight.begin(), weight.end());
    if (least <= best_least) continue;
    best_least = least;
    best.weight = weight;
    for (std::size_t n = 0; n < 4; ++n) {
      best.node[n] = nodes.number_of({cell[0] + (corners[n] & 1), cell[1] + (corners[n] >> 1 & 1),
                                      cell[2] + (corners[n] >> 2)});
    }
  }
  return best;
}
}  // namespace

CageWeights make_cage_weights(const std::string& place,
                              const Bounds& bounds,
                              const std::array<std::int64_t, 3>& cells,
                              std::int64_t parts,
                              const std::vector<Point3>& points) {
  const LatticeFrame coarse = fitted_frame(bounds, cells);
  const double edge =
      *std::min_element(coarse.edge.begin(), coarse.edge.end()) / static_cast<double>(parts);
  std::array<double, 3> counts{};
  for (std::size_t d = 0; d < 3; ++d) {
    counts[d] = static_cast<double>(cells[d]) * std::round(coarse.edge[d] / edge);
  }
  check_cells(key_of(place, "cage_start"), counts);
  const LatticeFrame fine = fitted_frame(
      bounds, {std::llround(counts[0]), std::llround(counts[1]), std::llround(counts[2])});
  const NodeIndex coarse_nodes = nodes_of(coarse);
  std::vector<Index3> vertices;
  CageWeights cage;
  for (std::int64_t n = 0; n < coarse_nodes.size(); ++n) {
    const Index3 node = coarse_nodes.node_of(n);
    if (!coarse_nodes.is_outer(node)) continue;
    vertices.push_back(node);
    cage.vertices.push_back({coarse.start[0] + coarse.edge[0] * static_cast<double>(node[0]),
                             coarse.start[1] + coarse.edge[1] * static_cast<double>(node[1]),
                             coarse.start[2] + coarse.edge[2] * static_cast<double>(node[2])});
  }
  if (points.size() >= (std::size_t{1} << 31) / vertices.size()) {
    fail_at(key_of(place, "cage_start"), "needs 2^31 or more weights; use fewer nodes");
  }
  cage.weight.resize(points.size() * vertices.size());
  std::vector<LatticePoint> places;
  places.reserve(points.size());
  for (const Point3& point : points) places.push_back(located(fine, point));
  const HarmonicWeights harmonic(coarse, fine);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Eigen::VectorXd weight = harmonic.of(vertices[v]);
    for (std::size_t p = 0; p < points.size(); ++p) {
      double sum = 0;
      for (std::size_t n = 0; n < 4; ++n) sum += places[p].weight[n] * weight[places[p].node[n]];
      cage.weight[p * vertices.size() + v] = sum;
    }
  }
  return cage;
}

std::vector<Point3> caged_points(const CageWeights& cage, const std::vector<Point3>& vertices) {
  std::vector<Point3> points(cage.weight.size() / cage.vertices.size(), {0, 0, 0});
  std::size_t w = 0;
  for (Point3& point : points) {
    for (const Point3& vertex : vertices) point = plus(point, times(cage.weight[w++], vertex));
  }
  return points;
}

}  // namespace tetwarp
