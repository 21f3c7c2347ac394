/// @file patch_supports.cpp
/// The convex hull of a flat patch, with few corners.
#include "host/simulate/patches/patch_supports.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "host/base/point3.hpp"
#include "host/simulate/patches/patch_frame.hpp"

namespace tetwarp {
namespace {
constexpr double cosine_half_degree = 0.9999619230641713;

double turn(double ax, double ay, double bx, double by) {
  return ax * by - ay * bx;
}

template <class Place>
double turn(const Place& o, const Place& p, const Place& q) {
  return turn(p.x - o.x, p.y - o.y, q.x - o.x, q.y - o.y);
}
}  // namespace

void PatchSupports::choose(const std::vector<ReportedContact>& contacts,
                           const std::vector<std::size_t>& patch,
                           double thickness,
                           std::vector<std::size_t>& chosen) {
  chosen.clear();
  left_ = patch;
  while (!left_.empty()) {
    const Point3& normal = contacts[left_[0]].normal;
    alike_.clear();
    next_left_.clear();
    for (const std::size_t c : left_) {
      const bool is_alike = dot(contacts[c].normal, normal) > cosine_half_degree;
      (is_alike ? alike_ : next_left_).push_back(c);
    }
    left_.swap(next_left_);
    if (alike_.size() <= most) {
      chosen.insert(chosen.end(), alike_.begin(), alike_.end());
    } else {
      choose_flat(contacts, thickness, chosen);
    }
  }
}

void PatchSupports::choose_flat(const std::vector<ReportedContact>& contacts,
                                double thickness,
                                std::vector<std::size_t>& chosen) {
  const PatchFrame frame(contacts[alike_[0]].normal, middle_of(contacts[alike_[0]]));
  places_.clear();
  double x = 0, y = 0;
  for (const std::size_t c : alike_) {
    const auto [u, w] = frame.place(middle_of(contacts[c]));
    places_.push_back({u, w, gap_of(contacts[c]), c});
    x += u / static_cast<double>(alike_.size());
    y += w / static_cast<double>(alike_.size());
  }
  size_ = 0;
  for (Place& place : places_) {
    place.x -= x;
    place.y -= y;
    size_ = std::max({size_, std::abs(place.x), std::abs(place.y)});
  }
  if (!is_flat(0.1 * thickness)) {
    chosen.insert(chosen.end(), alike_.begin(), alike_.end());
    return;
  }
  make_hull();
  const auto nearer = [](const Place& p, const Place& q) { return p.gap < q.gap; };
  const Place nearest = *std::min_element(places_.begin(), places_.end(), nearer);
  cut_corners(most);
  const Place& corner = *std::min_element(hull_.begin(), hull_.end(), nearer);
  if (nearest.gap < corner.gap - 0.01 * thickness) {
    cut_corners(most - 1);
    hull_.push_back(nearest);
  }
  for (const Place& place : hull_) chosen.push_back(place.contact);
}

/// Whether gaps differ from their fitted plane by no more than a tolerance.
bool PatchSupports::is_flat(double tolerance) const {
  double xx = 0, xy = 0, yy = 0, xg = 0, yg = 0, mean = 0;
  for (const Place& place : places_) {
    xx += place.x * place.x, xy += place.x * place.y, yy += place.y * place.y;
    xg += place.x * place.gap, yg += place.y * place.gap;
    mean += place.gap / static_cast<double>(places_.size());
  }
  const auto slope = slope_of(xx, xy, yy, xg, yg);
  return std::all_of(places_.begin(), places_.end(), [&](const Place& place) {
    const double plane = mean + slope[0] * place.x + slope[1] * place.y;
    return std::abs(place.gap - plane) <= tolerance;
  });
}

/// The convex hull, counterclockwise, without points on its sides. Points are visited by their
/// angle about the centroid, so that points on one side of the hull follow each other along it
/// whatever their rounding. Source: Graham 1972.
void PatchSupports::make_hull() {
  double xx = 0, xy = 0, yy = 0;
  for (const Place& place : places_) {
    xx += place.x * place.x, xy += place.x * place.y, yy += place.y * place.y;
  }
  const Axes2 axes = axes_of(xx, xy, yy);
  hull_.clear();
  if (axes.small <= 1e-12 * axes.large) {  // all on a line
    const double c = std::cos(axes.angle), s = std::sin(axes.angle);
    const auto [first, last] =
        std::minmax_element(places_.begin(), places_.end(), [&](const Place& p, const Place& q) {
          return std::pair(c * p.x + s * p.y, p.contact) < std::pair(c * q.x + s * q.y, q.contact);
        });
    hull_ = {*first, *last};
    return;
  }
  const auto far = [](const Place& place) { return place.x * place.x + place.y * place.y; };
  std::sort(places_.begin(), places_.end(), [&](const Place& p, const Place& q) {
    return std::tuple(std::atan2(p.y, p.x), far(p), p.contact) <
           std::tuple(std::atan2(q.y, q.x), far(q), q.contact);
  });
  const auto farthest =
      std::max_element(places_.begin(), places_.end(),
                       [&](const Place& p, const Place& q) { return far(p) < far(q); });
  std::rotate(places_.begin(), farthest, places_.end());
  const double even = 1e-9 * size_ * size_;
  const auto cut = [&](const Place& next) {
    while (hull_.size() >= 2 && turn(hull_[hull_.size() - 2], hull_.back(), next) <= even) {
      hull_.pop_back();
    }
  };
  for (const Place& place : places_) {
    cut(place);
    hull_.push_back(place);
  }
  cut(hull_.front());
}

/// Removes corners until `count` are left, each time the one whose triangle with its neighbors is
/// the smallest.
void PatchSupports::cut_corners(std::size_t count) {
  while (hull_.size() > count) {
    std::size_t smallest = 0;
    double least = 0;
    for (std::size_t i = 0; i < hull_.size(); ++i) {
      const double area = turn(hull_[(i + hull_.size() - 1) % hull_.size()], hull_[i],
                               hull_[(i + 1) % hull_.size()]);
      if (i > 0 && area >= least) continue;
      smallest = i;
      least = area;
    }
    hull_.erase(hull_.begin() + static_cast<std::ptrdiff_t>(smallest));
  }
}

}  // namespace tetwarp
