/// @file patch_moments.cpp
/// Integrates over the triangles of a patch, and places four points.
#include "host/simulate/patches/patch_moments.hpp"

#include <algorithm>
#include <cmath>

namespace tetwarp {
namespace {

/// The vertex of a contact, whose area the contact has.
std::int32_t vertex_of(const ReportedContact& contact) {
  return std::max(contact.key.feature_a, contact.key.feature_b);
}
}  // namespace

PatchPoints PatchMoments::points_of(const std::vector<ReportedContact>& contacts,
                                    const std::vector<std::size_t>& patch,
                                    const std::vector<Point3>& vertices) {
  PatchPoints result;
  corners_.clear();
  Point3 normal{0, 0, 0}, center{0, 0, 0};
  double gap = 0;
  for (const std::size_t c : patch) {
    const ReportedContact& contact = contacts[c];
    if (!(contact.area > 0)) continue;
    corners_.emplace_back(vertex_of(contact), c);
    result.area += contact.area;
    normal = plus(normal, times(contact.area, contact.normal));
    center = plus(center, times(contact.area, middle_of(contact)));
    gap += contact.area * gap_of(contact);
  }
  if (!(result.area > 0)) return result;
  std::sort(corners_.begin(), corners_.end());
  result.normal = unit(normal);
  center = times(1 / result.area, center);
  gap /= result.area;

  const PatchFrame frame(result.normal, center);
  Moments moments;
  double xg = 0, yg = 0;
  for (const auto& [vertex, c] : corners_) {
    const std::array<double, 2> x = frame.place(middle_of(contacts[c]));
    const double area = contacts[c].area, rise = gap_of(contacts[c]) - gap;
    moments.add(area, x);
    xg += area * x[0] * rise;
    yg += area * x[1] * rise;
  }
  const auto [slope_x, slope_y] = slope_of(moments.xx, moments.xy, moments.yy, xg, yg);
  spread_triangles(contacts, frame, vertices, moments);

  Axes2 axes = axes_of(moments.xx, moments.xy, moments.yy);
  if (axes.large - axes.small <= 1e-9 * axes.large) {  // any axes: the first to the farthest corner
    double farthest = 0;
    for (const auto& [vertex, c] : corners_) {
      const auto [x, y] = frame.place(middle_of(contacts[c]));
      if (std::hypot(x, y) <= (1 + 1e-9) * farthest) continue;
      farthest = std::hypot(x, y);
      axes.angle = std::atan2(y, x);
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const double moment = std::max(0.0, k < 2 ? axes.large : axes.small) / result.area;
    const double reach = (k % 2 == 0 ? 1 : -1) * std::sqrt(2 * moment);
    const double angle = axes.angle + (k < 2 ? 0 : std::acos(0.0));
    const double x = reach * std::cos(angle), y = reach * std::sin(angle);
    result.point[k] = {plus(center, frame.across(x, y)), gap + slope_x * x + slope_y * y};
  }
  return result;
}

/// Replaces area at the corners of triangles that touch with all three corners by area spread over
/// these triangles.
void PatchMoments::spread_triangles(const std::vector<ReportedContact>& contacts,
                                    const PatchFrame& frame,
                                    const std::vector<Point3>& vertices,
                                    Moments& moments) {
  const auto contact_at = [&](std::int32_t vertex) -> const ReportedContact* {
    const auto found =
        std::lower_bound(corners_.begin(), corners_.end(), std::pair(vertex, std::size_t{0}));
    return found != corners_.end() && found->first == vertex ? &contacts[found->second] : nullptr;
  };
  const TouchAreaView areas = areas_.view();
  const View<const double> at_start = numbers_of(vertices);
  for (const auto& [vertex, c] : corners_) {
    const ReportedContact& contact = contacts[c];
    const Vec3 normal = vec3_of(contact.normal);
    const double share = contact.area / seen_area(areas, vertex, normal, at_start);
    const AreasAround around = areas_around(areas, vertex, normal, at_start);
    const double side = around.along >= around.against ? 1 : -1;
    for (const std::int32_t t : areas_.triangles_around(vertex)) {
      const auto& triangle = at(surfaces_.triangles, t);
      if (*std::min_element(triangle.begin(), triangle.end()) != vertex) continue;
      const double area = share * side * facing_area(areas, t, normal, at_start);
      const ReportedContact* corner[3];
      for (std::size_t k = 0; k < 3; ++k) corner[k] = contact_at(triangle[k]);
      if (!(area > 0) || corner[0] == nullptr || corner[1] == nullptr || corner[2] == nullptr) {
        continue;
      }
      std::array<double, 2> sum{0, 0};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::array<double, 2> x = frame.place(middle_of(*corner[k]));
        sum = {sum[0] + x[0], sum[1] + x[1]};
        moments.add(area * (1.0 / 12 - 1.0 / 3), x);
      }
      moments.add(area / 12, sum);
    }
  }
}

}  // namespace tetwarp
