/// @file nearest.cpp
/// Nearest points of edges, triangles and tetrahedra, and the search through the grid.
#include "host/simulate/model/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetwarp {
namespace {

/// The nearest of the faces that lack one corner each.
template <std::size_t corners>
NearestPoint<corners> nearest_face(const std::array<Point3, corners>& item, const Point3& point) {
  NearestPoint<corners> best{0, {}, std::numeric_limits<double>::infinity()};
  for (std::size_t missing = 0; missing < corners; ++missing) {
    std::array<Point3, corners - 1> face;
    for (std::size_t c = 0, k = 0; c < corners; ++c) {
      if (c != missing) face[k++] = item[c];
    }
    const auto found = nearest_on(face, point);
    if (!(found.distance < best.distance)) continue;
    best.distance = found.distance;
    for (std::size_t c = 0, k = 0; c < corners; ++c) {
      best.weight[c] = c == missing ? 0 : found.weight[k++];
    }
  }
  return best;
}

double distance_to(const Bounds& box, const Point3& point) {
  double square = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const double outside = std::max({box.low[d] - point[d], point[d] - box.high[d], 0.0});
    square += outside * outside;
  }
  return std::sqrt(square);
}

}  // namespace

NearestPoint<2> nearest_on(const std::array<Point3, 2>& edge, const Point3& point) {
  const Point3 along = minus(edge[1], edge[0]);
  const double square = dot(along, along);
  const double t =
      square > 0 ? std::clamp(dot(minus(point, edge[0]), along) / square, 0.0, 1.0) : 0.0;
  const Point3 foot = plus(times(1 - t, edge[0]), times(t, edge[1]));
  return {0, {1 - t, t}, norm(minus(point, foot))};
}

NearestPoint<3> nearest_on(const std::array<Point3, 3>& triangle, const Point3& point) {
  const Point3 u = minus(triangle[1], triangle[0]), v = minus(triangle[2], triangle[0]);
  const Point3 normal = cross(u, v), x = minus(point, triangle[0]);
  const double square = dot(normal, normal);
  if (square > 0) {
    const double b = dot(cross(x, v), normal) / square, c = dot(cross(u, x), normal) / square;
    if (b >= 0 && c >= 0 && b + c <= 1) {
      const Point3 foot = plus(times(b, u), times(c, v));
      return {0, {1 - b - c, b, c}, norm(minus(x, foot))};
    }
  }
  return nearest_face(triangle, point);
}

NearestPoint<4> nearest_on(const std::array<Point3, 4>& tet, const Point3& point) {
  const double whole = tet_volume(tet[0], tet[1], tet[2], tet[3]);
  if (whole != 0) {
    NearestPoint<4> inside{0, {}, 0};
    bool is_inside = true;
    for (std::size_t c = 0; c < 4; ++c) {
      auto part = tet;
      part[c] = point;
      inside.weight[c] = tet_volume(part[0], part[1], part[2], part[3]) / whole;
      is_inside = is_inside && inside.weight[c] >= 0;
    }
    if (is_inside) return inside;
  }
  return nearest_face(tet, point);
}

template <std::size_t corners>
NearestItems<corners>::NearestItems(const std::vector<Point3>& points,
                                    const std::vector<Cell>& items)
    : points_(points), items_(items) {
  const auto count = static_cast<std::int32_t>(items_.size());
  double extent = 0;
  boxes_.resize(items_.size());
  for (std::int32_t i = 0; i < count; ++i) {
    Bounds& box = boxes_[static_cast<std::size_t>(i)];
    for (const Point3& corner : corners_of(i)) box.include(corner);
    bounds_.include(box.low);
    bounds_.include(box.high);
    for (std::size_t d = 0; d < 3; ++d) extent += (box.high[d] - box.low[d]) / (3.0 * count);
  }
  if (count == 0) {
    first_.assign(2, 0);
    return;
  }
  const Point3 size = minus(bounds_.high, bounds_.low);
  const double longest = std::max({size[0], size[1], size[2]});
  // Cubes of the mean box, at most about four per item.
  edge_ = std::max(extent, longest * 1e-9);
  if (!(edge_ > 0)) edge_ = 1;
  const auto cells = [&] {
    double product = 1;
    for (std::size_t d = 0; d < 3; ++d) product *= std::floor(size[d] / edge_) + 1;
    return product;
  };
  while (cells() > 4.0 * count + 64) edge_ *= 1.25;
  for (std::size_t d = 0; d < 3; ++d) {
    dims_[d] = static_cast<std::int64_t>(std::floor(size[d] / edge_)) + 1;
  }

  const auto each_cell = [&](std::int32_t i, auto visit) {
    const auto low = cell_of(boxes_[static_cast<std::size_t>(i)].low);
    const auto high = cell_of(boxes_[static_cast<std::size_t>(i)].high);
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
          visit(static_cast<std::size_t>(x + dims_[0] * (y + dims_[1] * z)));
        }
      }
    }
  };
  first_.assign(static_cast<std::size_t>(dims_[0] * dims_[1] * dims_[2]) + 1, 0);
  for (std::int32_t i = 0; i < count; ++i) each_cell(i, [&](std::size_t c) { ++first_[c + 1]; });
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  entries_.resize(static_cast<std::size_t>(first_.back()));
  std::vector<std::int64_t> next(first_.begin(), first_.end() - 1);
  for (std::int32_t i = 0; i < count; ++i) {
    each_cell(i, [&](std::size_t c) { entries_[static_cast<std::size_t>(next[c]++)] = i; });
  }
}

template <std::size_t corners>
std::array<Point3, corners> NearestItems<corners>::corners_of(std::int32_t item) const {
  std::array<Point3, corners> result;
  for (std::size_t c = 0; c < corners; ++c) result[c] = at(points_, at(items_, item)[c]);
  return result;
}

template <std::size_t corners>
std::array<std::int64_t, 3> NearestItems<corners>::cell_of(const Point3& point) const {
  std::array<std::int64_t, 3> cell;
  for (std::size_t d = 0; d < 3; ++d) {
    const double place = std::floor((point[d] - bounds_.low[d]) / edge_);
    cell[d] = static_cast<std::int64_t>(std::clamp(place, 0.0, static_cast<double>(dims_[d] - 1)));
  }
  return cell;
}

template <std::size_t corners>
template <class Visit>
void NearestItems<corners>::visit_shell(const std::array<std::int64_t, 3>& centre,
                                        std::int64_t shell,
                                        Visit visit) const {
  const auto low = [&](std::size_t d) { return std::max<std::int64_t>(centre[d] - shell, 0); };
  const auto high = [&](std::size_t d) { return std::min(centre[d] + shell, dims_[d] - 1); };
  const auto is_rim = [&](std::size_t d, std::int64_t at) {
    return at == centre[d] - shell || at == centre[d] + shell;
  };
  for (std::int64_t z = low(2); z <= high(2); ++z) {
    for (std::int64_t y = low(1); y <= high(1); ++y) {
      const bool all = is_rim(2, z) || is_rim(1, y) || shell == 0;
      for (std::int64_t x = low(0); x <= high(0); ++x) {
        if (!all && !is_rim(0, x)) {
          x = std::max(x, centre[0] + shell - 1);  // only the two ends of the row are on the shell
          continue;
        }
        const auto cell = static_cast<std::size_t>(x + dims_[0] * (y + dims_[1] * z));
        for (std::int64_t e = first_[cell]; e < first_[cell + 1]; ++e) {
          visit(entries_[static_cast<std::size_t>(e)]);
        }
      }
    }
  }
}

template <std::size_t corners>
NearestPoint<corners> NearestItems<corners>::find(const Point3& point) const {
  NearestPoint<corners> best{-1, {}, std::numeric_limits<double>::infinity()};
  if (items_.empty()) return best;
  const auto centre = cell_of(point);
  Point3 clamped;
  for (std::size_t d = 0; d < 3; ++d) {
    clamped[d] = std::clamp(point[d], bounds_.low[d], bounds_.high[d]);
  }
  const double outside = norm(minus(point, clamped));
  const std::int64_t last = std::max({dims_[0], dims_[1], dims_[2]});
  for (std::int64_t shell = 0; shell < last; ++shell) {
    // Cells not visited yet are at least `reach` from the clamped point, which is `outside` from
    // the point.
    const double reach = static_cast<double>(std::max<std::int64_t>(shell - 1, 0)) * edge_;
    if (best.distance == 0) break;  // all that contain the point are in its cell
    if (best.distance < std::hypot(outside, reach) * (1 - 1e-12)) break;
    visit_shell(centre, shell, [&](std::int32_t item) {
      if (distance_to(at(boxes_, item), point) * (1 - 1e-12) > best.distance) return;
      auto found = nearest_on(corners_of(item), point);
      const bool is_nearer =
          found.distance < best.distance || (found.distance == best.distance && item < best.item);
      if (!is_nearer) return;
      found.item = item;
      best = found;
    });
  }
  return best;
}

template class NearestItems<3>;
template class NearestItems<4>;

}  // namespace tetwarp
