/// @file surface_values.cpp
/// Means over tetrahedra, extremes over contacts.
#include "host/view/look/surface_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/box_tree.hpp"
#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
constexpr float no_value = std::numeric_limits<float>::quiet_NaN();

double volume_of(const Mesh& mesh, const std::array<std::int32_t, 4>& tet) {
  Point3 arm[3];
  const auto corner = [&](std::size_t c) {
    return mesh.rest_positions[static_cast<std::size_t>(tet[c])];
  };
  for (std::size_t c = 0; c < 3; ++c) arm[c] = minus(corner(c + 1), corner(0));
  return std::abs(dot(arm[0], cross(arm[1], arm[2]))) / 6;
}

/// Of each point the nearest one of others.
std::vector<std::size_t> nearest_points(const std::vector<Point3>& points,
                                        const std::vector<Point3>& others) {
  std::vector<Bounds> boxes;
  for (const Point3& x : others) boxes.push_back({x, x});
  const BoxTree tree(std::move(boxes));
  std::vector<std::size_t> nearest;
  for (const Point3& point : points) {
    double reach = std::numeric_limits<double>::infinity();
    std::int32_t found = 0;
    tree.visit_near(point, reach, [&](std::int32_t item) {
      const double distance = norm(minus(at(others, item), point));
      if (distance >= reach) return;
      reach = distance;
      found = item;
    });
    nearest.push_back(static_cast<std::size_t>(found));
  }
  return nearest;
}

/// The points of a surface at which a body touches.
std::vector<std::size_t> touching_points(const ContactPlace& place,
                                         const Point3& position,
                                         const std::vector<Point3>& points) {
  std::vector<std::size_t> touching;
  for (std::size_t n = 0; n < 3; ++n) {
    if (place.point[n] >= 0 && place.weight[n] > 0) {
      touching.push_back(static_cast<std::size_t>(place.point[n]));
    }
  }
  if (!touching.empty() || points.empty()) return touching;
  const auto distance = [&](const Point3& x) { return norm(minus(x, position)); };
  const auto nearest = std::ranges::min_element(points, {}, distance);
  return {static_cast<std::size_t>(nearest - points.begin())};
}
}  // namespace

SurfaceQuantity quantity_of(const std::string& word) {
  if (word == "stress") return SurfaceQuantity::stress;
  if (word == "gap") return SurfaceQuantity::gap;
  return word == "adhesion" ? SurfaceQuantity::adhesion : SurfaceQuantity::none;
}

std::string title_of(SurfaceQuantity quantity) {
  switch (quantity) {
    case SurfaceQuantity::stress:
      return "stress [Pa]";
    case SurfaceQuantity::gap:
      return "gap [m]";
    case SurfaceQuantity::adhesion:
      return "adhesion";
    case SurfaceQuantity::none:
      break;
  }
  return {};
}

std::vector<float> surface_means(const Mesh& mesh,
                                 const std::vector<double>& values,
                                 const BoundPoints& binding) {
  std::vector<double> sums(mesh.rest_positions.size(), 0), volumes(sums);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const double volume = volume_of(mesh, mesh.tets[t]);
    for (const std::int32_t node : mesh.tets[t]) {
      sums[static_cast<std::size_t>(node)] += volume * values[t];
      volumes[static_cast<std::size_t>(node)] += volume;
    }
  }
  std::vector<float> means;
  for (std::size_t p = 0; p < binding.nodes.size(); ++p) {
    double mean = 0;
    for (std::size_t n = 0; n < 4; ++n) {
      const auto node = static_cast<std::size_t>(binding.nodes[p][n]);
      if (volumes[node] > 0) mean += binding.weights[p][n] * sums[node] / volumes[node];
    }
    means.push_back(static_cast<float>(mean));
  }
  return means;
}

std::vector<std::vector<float>> SurfaceValues::of(SurfaceQuantity quantity) {
  if (quantity == SurfaceQuantity::none) return {};
  return quantity == SurfaceQuantity::stress ? stresses() : of_contacts(quantity);
}

std::vector<std::vector<float>> SurfaceValues::stresses() {
  const std::size_t bodies = simulator_.scene().bodies.size();
  std::vector<std::vector<float>> values(bodies);
  const bool is_first = bindings_.empty();
  for (std::size_t b = 0; b < bodies; ++b) {
    const BodyMesh& body = simulator_.body(b);
    if (is_first) bindings_.push_back(body.mesh.tets.empty() ? BoundPoints{} : looks_.binding(b));
    if (body.mesh.tets.empty()) {
      values[b].assign(body.surface.points.size(), no_value);
    } else {
      values[b] = surface_means(body.mesh, simulator_.cell_stresses(b), bindings_[b]);
    }
  }
  return values;
}

std::vector<std::vector<float>> SurfaceValues::of_contacts(SurfaceQuantity quantity) {
  const std::size_t bodies = simulator_.scene().bodies.size();
  std::vector<std::vector<float>> values(bodies);
  std::vector<std::vector<Point3>> points(bodies);
  for (std::size_t b = 0; b < bodies; ++b) {
    points[b] = simulator_.surface_positions(b);
    values[b].assign(points[b].size(), no_value);
  }
  for (const ContactPoint& contact : simulator_.contacts()) {
    const auto note = [&](std::size_t body, const ContactPlace& place) {
      if (body >= bodies) return;  // an obstacle
      for (const std::size_t p : touching_points(place, contact.position, points[body])) {
        float& value = values[body][p];
        value = quantity == SurfaceQuantity::gap
                    ? std::fmin(value, static_cast<float>(contact.gap))
                    : std::fmax(value, static_cast<float>(contact.intensity));
      }
    };
    note(contact.body_a, contact.place_a);
    note(contact.body_b, contact.place_b);
  }
  show_looks(values);
  return values;
}

/// Values of points that touch become those of points that are drawn.
void SurfaceValues::show_looks(std::vector<std::vector<float>>& values) {
  touching_.resize(values.size());
  for (std::size_t b = 0; b < values.size(); ++b) {
    if (looks_.of(b) == nullptr) continue;
    if (touching_[b].empty()) {
      touching_[b] = nearest_points(looks_.of(b)->points, simulator_.body(b).surface.points);
    }
    std::vector<float> shown;
    for (const std::size_t p : touching_[b]) shown.push_back(values[b][p]);
    values[b] = std::move(shown);
  }
}

}  // namespace tetwarp::view
