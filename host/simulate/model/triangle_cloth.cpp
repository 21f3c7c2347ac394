/// @file triangle_cloth.cpp
/// Weights of edges by the cotangents of the angles opposite to them.
#include "host/simulate/model/triangle_cloth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "host/base/point3.hpp"
#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/scalar_entries.hpp"

namespace tetwarp {
namespace {

/// An edge with the triangles beside it, in their order: one at the border, two elsewhere; more
/// where sheets of cloth meet.
struct EdgeUse {
  std::array<std::int32_t, 2> nodes{};  ///< ascending
  std::int32_t triangle = 0;
  std::int32_t opposite = 0;  ///< third node of the triangle
};

std::vector<EdgeUse> edge_uses(const std::vector<std::array<std::int32_t, 3>>& triangles) {
  std::vector<EdgeUse> uses;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t a = triangles[t][c], b = triangles[t][(c + 1) % 3];
      uses.push_back({{std::min(a, b), std::max(a, b)},
                      static_cast<std::int32_t>(t),
                      triangles[t][(c + 2) % 3]});
    }
  }
  std::stable_sort(uses.begin(), uses.end(),
                   [](const EdgeUse& a, const EdgeUse& b) { return a.nodes < b.nodes; });
  return uses;
}

/// Cotangent of the angle at `apex`.
double cotangent(const Point3& apex, const Point3& a, const Point3& b) {
  const Point3 u = minus(a, apex), v = minus(b, apex);
  return dot(u, v) / norm(cross(u, v));
}

class TriangleParts {
 public:
  TriangleParts(const BodyPart& part, Model& model, std::vector<ScalarEntry>& entries)
      : part_(part), model_(model), entries_(entries) {
    for (const auto& triangle : part.geometry.cloth_triangles) {
      const Point3 normal = cross(minus(rest(triangle[1]), rest(triangle[0])),
                                  minus(rest(triangle[2]), rest(triangle[0])));
      area_.push_back(norm(normal) / 2);
    }
  }

  void add() {
    const Cloth& cloth = part_.body.cloth;
    const auto& triangles = part_.geometry.cloth_triangles;
    node_area_.assign(part_.geometry.nodes.size(), 0);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (const std::int32_t node : triangles[t]) {
        node_area_[static_cast<std::size_t>(node)] += area_[t] / 3;
      }
    }
    for (std::size_t n = 0; n < node_area_.size(); ++n) {
      const std::int32_t number = part_.first_node + static_cast<std::int32_t>(n);
      entries_.push_back({number, number, cloth.areal_density * node_area_[n], 0});
    }
    laplacian_.resize(node_area_.size());
    is_border_.assign(node_area_.size(), 0);
    const std::vector<EdgeUse> uses = edge_uses(triangles);
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
      while (end < uses.size() && uses[end].nodes == uses[begin].nodes) ++end;
      add_edge(&uses[begin], &uses[begin] + (end - begin));
    }
    if (cloth.bend > 0) add_bending();
  }

 private:
  const Point3& rest(std::int32_t node) const { return at(part_.geometry.nodes, node); }

  void add_spring(std::int32_t a, std::int32_t b, double stiffness) {
    const double length = norm(minus(rest(a), rest(b)));
    if (stiffness == 0 || !(length > 0)) return;
    model_.edges.nodes.push_back({part_.first_node + a, part_.first_node + b});
    model_.edges.stiffness.push_back(stiffness);
    model_.edges.rest_length.push_back(length);
    model_.edges.gamma.push_back(part_.body.damping.gamma);
  }

  void add_edge(const EdgeUse* begin, const EdgeUse* end) {
    const auto [a, b] = begin->nodes;
    const Point3 line = minus(rest(b), rest(a));
    double area = 0, weight = 0;
    for (const EdgeUse* use = begin; use != end; ++use) {
      area += at(area_, use->triangle);
      weight += cotangent(rest(use->opposite), rest(a), rest(b)) / 2;
    }
    // The strip of cloth along the edge has the area of its triangles: width w = area / length.
    add_spring(a, b, part_.body.cloth.stretch * area / dot(line, line));
    if (end - begin == 2) {
      // Springs k of length L in all directions resist shear by sum k L^2 / 8 per area, and every
      // triangle belongs to three such quads.
      const std::int32_t c = begin->opposite, d = (begin + 1)->opposite;
      const Point3 across = minus(rest(d), rest(c));
      const double square = dot(across, across);
      if (square > 0) add_spring(c, d, part_.body.cloth.shear * 8 * area / (3 * square));
    } else {
      is_border_[static_cast<std::size_t>(a)] = is_border_[static_cast<std::size_t>(b)] = 1;
    }
    laplacian_[static_cast<std::size_t>(a)].push_back({b, weight});
    laplacian_[static_cast<std::size_t>(b)].push_back({a, weight});
  }

  /// B/2 times the squared mean-curvature vector |sum_j w_ij (x_j - x_i)|^2 / area of inner nodes.
  void add_bending() {
    for (std::size_t n = 0; n < laplacian_.size(); ++n) {
      if (is_border_[n] != 0 || !(node_area_[n] > 0)) continue;
      auto& row = laplacian_[n];
      double sum = 0;
      for (const auto& [node, weight] : row) sum += weight;
      row.push_back({static_cast<std::int32_t>(n), -sum});
      for (const auto& [a, weight_a] : row) {
        for (const auto& [b, weight_b] : row) {
          const double bend = part_.body.cloth.bend / node_area_[n] * weight_a * weight_b;
          entries_.push_back({part_.first_node + a, part_.first_node + b, 0, bend});
        }
      }
    }
  }

  struct Weight {
    std::int32_t node;
    double weight;
  };
  const BodyPart& part_;
  Model& model_;
  std::vector<ScalarEntry>& entries_;
  std::vector<double> area_, node_area_;
  std::vector<std::vector<Weight>> laplacian_;
  std::vector<std::uint8_t> is_border_;
};

}  // namespace

void add_triangle_cloth(const BodyPart& part, Model& model, std::vector<ScalarEntry>& entries) {
  TriangleParts(part, model, entries).add();
}

}  // namespace tetwarp
