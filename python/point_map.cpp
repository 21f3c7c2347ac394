/// @file point_map.cpp
/// Finds the owners of points by a uniform grid of the tetrahedra's boxes.
#include "python/point_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

#include "host/base/index_space.hpp"
#include "host/base/point3.hpp"
#include "kernels/warp/face_sign.hpp"

namespace tetwarp::python {
namespace {
constexpr std::int64_t no_frame[3] = {0, 0, 0};

struct Box {
  std::array<std::int64_t, 3> low, high;  // [quantum], closed

  void include(const std::int64_t* x) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], x[axis]);
      high[axis] = std::max(high[axis], x[axis]);
    }
  }
};

Box box_of(const TetNodes& tet) {
  Box box{{tet.x[0][0], tet.x[0][1], tet.x[0][2]}, {tet.x[0][0], tet.x[0][1], tet.x[0][2]}};
  for (int a = 1; a < 4; ++a) box.include(tet.x[a]);
  return box;
}

/// Which tetrahedra may contain a point: those whose boxes overlap its cube of a uniform grid.
class TetSearch {
 public:
  /// @param tets  at least one
  explicit TetSearch(const std::vector<TetNodes>& tets) : bounds_(box_of(tets.front())) {
    for (const TetNodes& tet : tets) {
      for (const auto& node : tet.x) bounds_.include(node);
    }
    choose_edge(tets.size());
    // Counting sort: tetrahedra in ascending order in every cube.
    first_.assign(static_cast<std::size_t>(dims_[0] * dims_[1] * dims_[2]) + 1, 0);
    for (const TetNodes& tet : tets) {
      visit(box_of(tet), [&](std::size_t cube) { ++first_[cube + 1]; });
    }
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    entries_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t t = 0; t < tets.size(); ++t) {
      visit(box_of(tets[t]),
            [&](std::size_t cube) { entries_[next[cube]++] = static_cast<std::int32_t>(t); });
    }
  }

  /// Ascending.
  std::span<const std::int32_t> candidates(const Node& point) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (point.x[axis] < bounds_.low[axis] || point.x[axis] > bounds_.high[axis]) return {};
    }
    const std::size_t cube =
        cube_of({place(point.x[0], 0), place(point.x[1], 1), place(point.x[2], 2)});
    return {entries_.data() + first_[cube], first_[cube + 1] - first_[cube]};
  }

 private:
  /// About two cubes per tetrahedron, at most 128 along an axis.
  void choose_edge(std::size_t tet_count) {
    std::int64_t longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      longest = std::max(longest, bounds_.high[axis] - bounds_.low[axis]);
    }
    const double along = std::clamp(std::cbrt(2.0 * static_cast<double>(tet_count)), 1.0, 128.0);
    edge_ = longest / static_cast<std::int64_t>(along) + 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      dims_[axis] = (bounds_.high[axis] - bounds_.low[axis]) / edge_ + 1;
    }
  }

  std::int64_t place(std::int64_t x, std::size_t axis) const {
    return (x - bounds_.low[axis]) / edge_;
  }

  std::size_t cube_of(const std::array<std::int64_t, 3>& ijk) const {
    return static_cast<std::size_t>(ijk[0] + dims_[0] * (ijk[1] + dims_[1] * ijk[2]));
  }

  template <class Visit>
  void visit(const Box& box, const Visit& visit) const {
    std::array<std::int64_t, 3> from, to;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      from[axis] = place(box.low[axis], axis);
      to[axis] = place(box.high[axis], axis);
    }
    for (std::int64_t k = from[2]; k <= to[2]; ++k) {
      for (std::int64_t j = from[1]; j <= to[1]; ++j) {
        for (std::int64_t i = from[0]; i <= to[0]; ++i) visit(cube_of({i, j, k}));
      }
    }
  }

  Box bounds_;
  std::int64_t edge_ = 1;  // of a cube [quantum]
  std::array<std::int64_t, 3> dims_{1, 1, 1};
  std::vector<std::size_t> first_;  // [cubes + 1]
  std::vector<std::int32_t> entries_;
};

std::vector<Node> quantized_nodes(const IndexFromWorld& map, const std::vector<Point3>& points) {
  std::vector<Node> nodes(points.size());
  for (std::size_t n = 0; n < points.size(); ++n) {
    nodes[n] = quantized(map, points[n].data(), no_frame);
  }
  return nodes;
}

std::vector<TetNodes> rounded_tets(const IndexFromWorld& map,
                                   const std::vector<Point3>& points,
                                   const std::vector<std::array<std::int32_t, 4>>& tets) {
  const std::vector<Node> nodes = quantized_nodes(map, points);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].x[0] != bad_node) continue;
    throw std::invalid_argument("node " + std::to_string(n) +
                                " is not finite or over 2^40 voxels from the grid");
  }
  const View<const Node> view{nodes.data(), static_cast<std::int64_t>(nodes.size())};
  std::vector<TetNodes> rounded;
  rounded.reserve(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    rounded.push_back(tet_nodes(view, tets[t].data()));
    const Box box = box_of(rounded.back());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (box.high[axis] - box.low[axis] <= longest_extent) continue;
      throw std::invalid_argument("tetrahedron " + std::to_string(t) +
                                  " spans over 2^20 voxels of the grid");
    }
  }
  return rounded;
}

/// Whether a tetrahedron contains a point: the point becomes the voxel at the origin.
bool contains(TetNodes tet, const Node& point) {
  for (auto& node : tet.x) {
    for (int axis = 0; axis < 3; ++axis) node[axis] -= point.x[axis];
  }
  return is_inside_exact(tet, 0, 0, 0);
}

/// The point plus the mean of the nodes' displacements by its barycentric coordinates, so that
/// nodes that stay take no point along. Tetrahedra that are flat before rounding use their first
/// node.
Point3 moved(const Point3& x,
             const std::array<std::int32_t, 4>& tet,
             const std::vector<Point3>& from,
             const std::vector<Point3>& to) {
  std::array<Point3, 4> corner, displacement;
  for (std::size_t a = 0; a < 4; ++a) {
    corner[a] = at(from, tet[a]);
    displacement[a] = minus(at(to, tet[a]), corner[a]);
  }
  const double volume = tet_volume(corner[0], corner[1], corner[2], corner[3]);
  if (volume == 0) return plus(x, displacement[0]);
  Point3 result = plus(x, displacement[0]);
  for (std::size_t a = 1; a < 4; ++a) {
    std::array<Point3, 4> part = corner;
    part[a] = x;
    const double weight = tet_volume(part[0], part[1], part[2], part[3]) / volume;
    result = plus(result, times(weight, minus(displacement[a], displacement[0])));
  }
  return result;
}
}  // namespace

MappedPoints map_points(const std::vector<Point3>& points,
                        const Grid& grid,
                        const std::vector<Point3>& from,
                        const std::vector<std::array<std::int32_t, 4>>& tets,
                        const std::vector<Point3>& to) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  MappedPoints mapped{std::vector<Point3>(points.size(), Point3{none, none, none}),
                      std::vector<std::int32_t>(points.size(), -1)};
  const IndexFromWorld index = index_from_world(grid);
  const std::vector<TetNodes> rounded = rounded_tets(index, from, tets);
  const TetSearch search(rounded);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Node point = quantized(index, points[p].data(), no_frame);
    if (point.x[0] == bad_node) continue;
    for (const std::int32_t t : search.candidates(point)) {
      if (!contains(at(rounded, t), point)) continue;
      mapped.owners[p] = t;
      mapped.points[p] = moved(points[p], at(tets, t), from, to);
      break;
    }
  }
  return mapped;
}

}  // namespace tetwarp::python
