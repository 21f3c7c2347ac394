/// @file selection.cpp
/// Tests each point against the parts of a selection.
#include "host/scene/selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <variant>

#include "host/scene/checks/scene_checks.hpp"
#include "host/scene/pose.hpp"
#include "host/scene/voxel_owner.hpp"

namespace tetwarp {
namespace {
constexpr double rounding_share = 1e-9;  // of the largest coordinate

/// Marks what the parts of a selection select.
class Marks {
 public:
  Marks(const std::string& place, const Body& body, const BodyParts& parts, Selectable from)
      : place_(place), body_(body), parts_(parts) {
    const BodyGeometry& geometry = parts.geometry;
    takes_nodes_ = !geometry.nodes.empty() && from == Selectable::nodes;
    const std::vector<Point3>& points = takes_nodes_ ? geometry.nodes : geometry.surface.points;
    const RotationMatrix rotation = rotation_of(body.pose.rotation);
    positions_.reserve(points.size());
    for (const Point3& x : points) {
      positions_.push_back(plus(body.pose.position, times(rotation, x)));
      for (const double coordinate : positions_.back()) {
        rounding_ = std::max(rounding_, rounding_share * std::fabs(coordinate));
      }
    }
    marks_.resize(points.size());
  }

  void operator()(const BoxSelection& box) {
    mark_where([&](const Point3& x) {
      for (std::size_t d = 0; d < 3; ++d) {
        if (x[d] < box.low[d] - rounding_ || x[d] > box.high[d] + rounding_) return false;
      }
      return true;
    });
  }
  void operator()(const SphereSelection& sphere) {
    mark_where([&](const Point3& x) {
      return norm(minus(x, sphere.center)) <= sphere.radius + rounding_;
    });
  }
  void operator()(const HalfSpaceSelection& half) {
    const double least = half.offset - rounding_ * norm(half.normal);
    mark_where([&](const Point3& x) { return dot(half.normal, x) >= least; });
  }
  void operator()(const AllSelection&) { std::fill(marks_.begin(), marks_.end(), 1); }

  void operator()(const NodeSelection& selection) {
    const bool is_renumbered = takes_nodes_ && !parts_.node_number.empty();
    const std::size_t count = is_renumbered ? parts_.node_number.size() : marks_.size();
    for (const std::int64_t given : selection.nodes) {
      if (given < 0 || static_cast<std::size_t>(given) >= count) {
        fail_at(place_, "node " + std::to_string(given) + " does not exist, expected 0 to " +
                            std::to_string(static_cast<std::int64_t>(count) - 1));
      }
      const auto node = static_cast<std::size_t>(given);
      const std::int64_t number = is_renumbered ? parts_.node_number[node] : given;
      if (number < 0) {
        fail_at(place_, "node " + std::to_string(given) + " belongs to no cell of the mesh");
      }
      marks_[static_cast<std::size_t>(number)] = 1;
    }
  }

  void operator()(const LabelSelection& label) {
    const auto* image = std::get_if<ImageGeometry>(&body_.geometry);
    const BodyGeometry& geometry = parts_.geometry;
    if (!image || geometry.tets.empty() || !takes_nodes_) {
      fail_at(place_,
              "a label selects nodes of tetrahedra, which are not there; select by box, sphere or "
              "nodes");
    }
    for (const std::int32_t tet : tets_of_value(image->volume, geometry, label.value)) {
      for (const std::int32_t node : at(geometry.tets, tet)) {
        marks_[static_cast<std::size_t>(node)] = 1;
      }
    }
  }

  std::vector<std::int32_t> list() const {
    std::vector<std::int32_t> points;
    for (std::size_t p = 0; p < marks_.size(); ++p) {
      if (marks_[p]) points.push_back(static_cast<std::int32_t>(p));
    }
    return points;
  }

  /// Of the points to select from, at the start [world].
  const std::vector<Point3>& positions() const { return positions_; }

 private:
  template <class Test>
  void mark_where(const Test& test) {
    for (std::size_t p = 0; p < marks_.size(); ++p) {
      if (test(positions_[p])) marks_[p] = 1;
    }
  }

  const std::string& place_;
  const Body& body_;
  const BodyParts& parts_;
  bool takes_nodes_ = false;
  std::vector<Point3> positions_;
  double rounding_ = 0;  ///< by which positions may miss decimals [m]
  std::vector<std::uint8_t> marks_;
};
}  // namespace

std::vector<std::int32_t> select(const std::string& place,
                                 const Selection& selection,
                                 const Body& body,
                                 const BodyParts& parts,
                                 Selectable from) {
  Marks marks(place, body, parts, from);
  for (const SelectionPart& part : selection) std::visit(marks, part);
  std::vector<std::int32_t> points = marks.list();
  if (!points.empty()) return points;
  const Bounds bounds = bounds_of(marks.positions());
  const auto text = [](const Point3& x) {
    std::string numbers = "[";
    numbers += number_text(x[0]) + ", " + number_text(x[1]) + ", " + number_text(x[2]);
    return numbers += "]";
  };
  fail_at(place, "selects nothing; at the start '" + body.name + "' spans " + text(bounds.low) +
                     " to " + text(bounds.high) + " m");
}

}  // namespace tetwarp
