/// @file loft_line.cpp
/// Interpolates stations, integrates, and refuses tubes that fold.
#include "host/scene/shapes/loft_line.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
/// Samples of a segment for checks, and parts of it for integrals.
constexpr int segment_parts = 16;
/// Largest extent of a cross-section towards the center of curvature, in radii of curvature.
constexpr double largest_bend = 0.95;
/// Most radii from one end to the other.
constexpr double most_radii = 1e4;

std::string station_place(std::size_t n) {
  return item_of("stations", n);
}

void check_tube(const LoftTube& tube) {
  if (tube.stations.size() < 2) fail_at("stations", "expected two or more");
  for (std::size_t n = 0; n < tube.stations.size(); ++n) {
    const LoftStation& station = tube.stations[n];
    check_finite(key_of(station_place(n), "center"), station.center);
    check_finite(key_of(station_place(n), "direction"), station.direction);
    for (const double radius : station.radii) {
      check_positive(key_of(station_place(n), "radii"), radius, "m");
    }
    if (n > 0 && !(norm(minus(station.center, tube.stations[n - 1].center)) > 0)) {
      fail_at(key_of(station_place(n), "center"), "is that of the station before, move it");
    }
  }
  for (const double end : tube.ends) check_positive("ends", end, "m");
  double length = tube.ends[0] + tube.ends[1], radius = 0;
  for (std::size_t n = 0; n < tube.stations.size(); ++n) {
    const LoftStation& station = tube.stations[n];
    radius = std::max({radius, station.radii[0], station.radii[1]});
    if (n > 0) length += norm(minus(station.center, tube.stations[n - 1].center));
  }
  if (!(length <= most_radii * radius && radius <= most_radii * length)) {
    fail_at("stations", "are " + number_text(length) + " m long and at most " +
                            number_text(radius) +
                            " m wide; expected 0.0001 to 10,000 times as long as wide");
  }
}

Point3 perpendicular(const Point3& direction, const Point3& along) {
  return minus(direction, times(dot(direction, along), along));
}

/// The axis of the world that is furthest from a direction.
Point3 other_axis(const Point3& along) {
  std::size_t least = 0;
  for (std::size_t d = 1; d < 3; ++d) {
    if (std::abs(along[d]) < std::abs(along[least])) least = d;
  }
  Point3 axis{0, 0, 0};
  axis[least] = 1;
  return axis;
}

/// A vector after the shortest turn that takes the unit vector a to b.
Point3 turned(const Point3& vector, const Point3& a, const Point3& b) {
  const Point3 axis = cross(a, b);  // of length sin
  const double cosine = dot(a, b);
  if (!(1 + cosine > 0)) return vector;
  return plus(plus(times(cosine, vector), cross(axis, vector)),
              times(dot(axis, vector) / (1 + cosine), axis));
}

double radius_slope(double before, double after) {
  return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

/// Cubic of values and derivatives at both ends of [0, h], with its first two derivatives.
struct Cubic {
  std::array<double, 4> value, first, second;  // factors of a, b, h a', h b'
  double h;

  Cubic(double s, double length) : h(length) {
    const double s2 = s * s, s3 = s2 * s;
    value = {1 - 3 * s2 + 2 * s3, 3 * s2 - 2 * s3, s - 2 * s2 + s3, s3 - s2};
    first = {6 * s2 - 6 * s, 6 * s - 6 * s2, 1 - 4 * s + 3 * s2, 3 * s2 - 2 * s};
    second = {12 * s - 6, 6 - 12 * s, 6 * s - 4, 6 * s - 2};
  }
  double of(const std::array<double, 4>& factor, double a, double b, double da, double db) const {
    return factor[0] * a + factor[1] * b + h * (factor[2] * da + factor[3] * db);
  }
  Point3 of(const std::array<double, 4>& factor,
            const Point3& a,
            const Point3& b,
            const Point3& da,
            const Point3& db) const {
    Point3 x;
    for (std::size_t d = 0; d < 3; ++d) x[d] = of(factor, a[d], b[d], da[d], db[d]);
    return x;
  }
};
}  // namespace

Point3 LoftSection::point(double x, double y) const {
  return plus(center, plus(times(radii[0] * x, across[0]), times(radii[1] * y, across[1])));
}

LoftLine::LoftLine(const LoftTube& tube) : tube_(tube) {
  check_tube(tube);
  const std::vector<LoftStation>& stations = tube.stations;
  const std::size_t count = stations.size();
  std::vector<Point3> chord;  // per segment its direction
  std::vector<double> length;
  place_.push_back(0);
  for (std::size_t n = 0; n + 1 < count; ++n) {
    const Point3 step = minus(stations[n + 1].center, stations[n].center);
    length.push_back(norm(step));
    chord.push_back(times(1 / length.back(), step));
    place_.push_back(place_.back() + length.back());
  }
  tangent_.resize(count);
  slope_.assign(count, {0, 0});
  for (std::size_t n = 1; n + 1 < count; ++n) {
    const double before = length[n - 1], after = length[n];
    tangent_[n] =
        times(1 / (before + after), plus(times(after, chord[n - 1]), times(before, chord[n])));
    for (std::size_t r = 0; r < 2; ++r) {
      const double here = stations[n].radii[r];
      slope_[n][r] = radius_slope((here - stations[n - 1].radii[r]) / before,
                                  (stations[n + 1].radii[r] - here) / after);
    }
  }
  const bool is_straight = count == 2;
  tangent_.front() = is_straight ? chord[0] : minus(times(2, chord.front()), tangent_[1]);
  tangent_.back() = is_straight ? chord[0] : minus(times(2, chord.back()), tangent_[count - 2]);
  Point3 direction = other_axis(unit(tangent_[0]));
  for (std::size_t n = 0; n < count; ++n) {
    if (n > 0) direction = turned(direction, unit(tangent_[n - 1]), unit(tangent_[n]));
    if (norm(stations[n].direction) > 0) direction = unit(stations[n].direction);
    direction_.push_back(direction);
  }
  check_bends();
}

LoftSection LoftLine::section_between(double place) const {
  const auto after = std::upper_bound(place_.begin() + 1, place_.end() - 1, place);
  const auto b = static_cast<std::size_t>(after - place_.begin()), a = b - 1;
  const double h = place_[b] - place_[a], s = (place - place_[a]) / h;
  const Cubic cubic(s, h);
  const LoftStation &from = tube_.stations[a], &to = tube_.stations[b];
  const auto line = [&](const std::array<double, 4>& factor) {
    return cubic.of(factor, from.center, to.center, tangent_[a], tangent_[b]);
  };
  LoftSection section;
  section.center = line(cubic.value);
  const Point3 velocity = times(1 / h, line(cubic.first));
  section.speed = norm(velocity);
  section.along = unit(velocity);
  section.bend = times(1 / (h * h * section.speed * section.speed),
                       perpendicular(line(cubic.second), section.along));
  for (std::size_t r = 0; r < 2; ++r) {
    section.radii[r] =
        cubic.of(cubic.value, from.radii[r], to.radii[r], slope_[a][r], slope_[b][r]);
  }
  const Point3 direction =
      plus(times(cubic.value[0], direction_[a]), times(cubic.value[1], direction_[b]));
  const Point3 across = perpendicular(direction, section.along);
  if (!(norm(across) > 0.1 * norm(direction)) || !(section.speed > 0)) {
    fail_at(key_of(station_place(s < 0.5 ? a : b), "direction"),
            "is along the center line or opposite to the next one, turn it");
  }
  section.across[0] = unit(across);
  section.across[1] = cross(section.along, section.across[0]);
  return section;
}

LoftSection LoftLine::wide_section(double place) const {
  const double inside = std::clamp(place, 0.0, place_.back());
  LoftSection section = section_between(inside);
  section.center = plus(section.center, times(place - inside, section.along));
  return section;
}

LoftSection LoftLine::section(double place) const {
  LoftSection section = wide_section(place);
  const double beyond = place - std::clamp(place, 0.0, place_.back());
  const double depth = std::min(1.0, std::abs(beyond) / tube_.ends[place < 0 ? 0 : 1]);
  for (double& radius : section.radii) radius *= std::sqrt(1 - depth * depth);
  return section;
}

double LoftLine::volume() const {
  // Gauss and Legendre's rule of five points.
  constexpr double at[] = {0, 0.5384693101056831, 0.9061798459386640};
  constexpr double weight[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  double sum = 0;
  for (std::size_t n = 0; n + 1 < place_.size(); ++n) {
    const double half = (place_[n + 1] - place_[n]) / (2 * segment_parts);
    for (int part = 0; part < segment_parts; ++part) {
      const double middle = place_[n] + half * (2 * part + 1);
      for (int g = -2; g <= 2; ++g) {
        const int k = std::abs(g);
        const LoftSection s = section_between(middle + (g < 0 ? -half : half) * at[k]);
        sum += half * weight[k] * s.radii[0] * s.radii[1] * s.speed;
      }
    }
  }
  const auto end = [](const LoftStation& station, double length) {
    return 2.0 / 3 * station.radii[0] * station.radii[1] * length;
  };
  sum += end(tube_.stations.front(), tube_.ends[0]) + end(tube_.stations.back(), tube_.ends[1]);
  return std::numbers::pi * sum;
}

void LoftLine::check_bends() const {
  for (std::size_t n = 0; n + 1 < place_.size(); ++n) {
    for (int part = 0; part <= segment_parts; ++part) {
      const double share = double{1} * part / segment_parts;
      const LoftSection s = section_between(place_[n] + share * (place_[n + 1] - place_[n]));
      const double extent =
          std::hypot(s.radii[0] * dot(s.bend, s.across[0]), s.radii[1] * dot(s.bend, s.across[1]));
      if (extent < largest_bend) continue;
      fail_at(station_place(share < 0.5 ? n : n + 1),
              "the center line bends so much that cross-sections meet; use smaller radii or more "
              "stations on a wider bend");
    }
  }
}

}  // namespace tetwarp
