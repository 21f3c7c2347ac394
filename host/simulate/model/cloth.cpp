/// @file cloth.cpp
/// Springs and bending of sheets, and lumped masses of all cloth.
#include "host/simulate/model/cloth.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/base/point3.hpp"
#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/scalar_entries.hpp"
#include "host/simulate/model/triangle_cloth.hpp"

namespace tetwarp {

namespace {

/// Adds a sheet of squares. Its nodes are numbered along u first.
class SheetParts {
 public:
  SheetParts(const BodyPart& part, Model& model, std::vector<ScalarEntry>& entries)
      : part_(part), model_(model), entries_(entries), cells_(part.geometry.sheet_cells) {
    edge_ = {norm(minus(node(1, 0), node(0, 0))), norm(minus(node(0, 1), node(0, 0)))};
    if (!(edge_[0] > 0) || !(edge_[1] > 0)) {
      throw std::invalid_argument(error_prefix(part) + "its sheet has cells without area");
    }
  }

  void add() {
    const Cloth& cloth = part_.body.cloth;
    const double area = edge_[0] * edge_[1];
    // Both diagonals of a cell resist shear: 2 k/2 (L gamma sin cos)^2 = S gamma^2 area / 2.
    const double diagonal = cloth.shear * (edge_[0] * edge_[0] + edge_[1] * edge_[1]) / (2 * area);
    for (std::int64_t v = 0; v <= cells_[1]; ++v) {
      for (std::int64_t u = 0; u <= cells_[0]; ++u) {
        const std::array<std::int64_t, 2> uv{u, v};
        const double share = side_share(uv, 0) * side_share(uv, 1);
        entries_.push_back({number(uv), number(uv), cloth.areal_density * area * share, 0});
        add_line(uv, 0);
        add_line(uv, 1);
        if (u == cells_[0] || v == cells_[1]) continue;
        add_spring({u, v}, {u + 1, v + 1}, diagonal);
        add_spring({u + 1, v}, {u, v + 1}, diagonal);
      }
    }
  }

 private:
  using Place = std::array<std::int64_t, 2>;

  std::int32_t local(const Place& uv) const {
    return static_cast<std::int32_t>(uv[0] + (cells_[0] + 1) * uv[1]);
  }
  std::int32_t number(const Place& uv) const { return part_.first_node + local(uv); }
  const Point3& node(std::int64_t u, std::int64_t v) const {
    return at(part_.geometry.nodes, local({u, v}));
  }
  /// 1/2 at the border across `axis`: the strip of cloth around the node is half as wide there.
  double side_share(const Place& uv, std::size_t axis) const {
    return uv[axis] == 0 || uv[axis] == cells_[axis] ? 0.5 : 1.0;
  }
  void add_spring(const Place& a, const Place& b, double stiffness) {
    if (stiffness == 0) return;
    const double length = norm(minus(node(a[0], a[1]), node(b[0], b[1])));
    model_.edges.nodes.push_back({number(a), number(b)});
    model_.edges.stiffness.push_back(stiffness);
    model_.edges.rest_length.push_back(length);
    model_.edges.gamma.push_back(part_.body.damping.gamma);
  }
  /// The edge from a node along an axis, and the second difference that begins with it.
  void add_line(const Place& uv, std::size_t axis) {
    if (uv[axis] == cells_[axis]) return;
    const Cloth& cloth = part_.body.cloth;
    const double width = edge_[1 - axis] * side_share(uv, 1 - axis), length = edge_[axis];
    Place next = uv;
    ++next[axis];
    add_spring(uv, next, cloth.stretch * width / length);
    if (next[axis] == cells_[axis] || cloth.bend == 0) return;
    Place second = next;
    ++second[axis];
    const double weight = cloth.bend * width / (length * length * length);
    const std::array<std::int32_t, 3> nodes{number(uv), number(next), number(second)};
    constexpr std::array<double, 3> factor{1, -2, 1};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) {
        entries_.push_back({nodes[a], nodes[b], 0, weight * factor[a] * factor[b]});
      }
    }
  }

  const BodyPart& part_;
  Model& model_;
  std::vector<ScalarEntry>& entries_;
  std::array<std::int64_t, 2> cells_;
  std::array<double, 2> edge_{};
};

}  // namespace

void add_cloth(const BodyPart& part, Model& model) {
  std::vector<ScalarEntry> entries;
  if (part.geometry.sheet_cells[0] > 0) {
    SheetParts(part, model, entries).add();
  } else {
    add_triangle_cloth(part, model, entries);
  }
  for (const ScalarEntry& entry : entries) {
    model.node_mass[static_cast<std::size_t>(entry.row)] += entry.mass;
  }
  for (std::size_t n = 0; n < part.geometry.nodes.size(); ++n) {
    if (model.node_mass[static_cast<std::size_t>(part.first_node) + n] > 0) continue;
    throw std::invalid_argument(error_prefix(part) + "node " + std::to_string(n) +
                                " belongs to no triangle with an area; remove it from the mesh");
  }
  add_scalar_entries(std::move(entries), part.body.damping, model);
}

}  // namespace tetwarp
