/// @file point_search.cpp
/// Rounds the nodes, computes planes, and lists the tetrahedra of each cube.
#include "host/warp/point_search.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {
namespace {
using Tets = std::vector<std::array<std::int32_t, 4>>;

struct QuantaBox {
  std::array<std::int64_t, 3> low, high;  // closed

  explicit QuantaBox(const TetNodes& tet) : low{tet.x[0][0], tet.x[0][1], tet.x[0][2]}, high(low) {
    for (const auto& node : tet.x) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], node[axis]);
        high[axis] = std::max(high[axis], node[axis]);
      }
    }
  }
};

std::vector<Node> rounded_nodes(const IndexFromWorld& map, const std::vector<Point3>& nodes) {
  constexpr std::int64_t no_frame[3] = {0, 0, 0};
  std::vector<Node> rounded(nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    rounded[n] = quantized(map, nodes[n].data(), no_frame);
    if (rounded[n].x[0] == bad_node) {
      throw std::invalid_argument("mesh: node " + std::to_string(n) +
                                  " is over 2^40 voxels from the grid");
    }
  }
  return rounded;
}

class SearchMaker {
 public:
  SearchMaker(const IndexFromWorld& map, const std::vector<Point3>& nodes, const Tets& tets)
      : tets_(tets) {
    search_.rounded = rounded_nodes(map, nodes);
    set_bounds();
    choose_edge();
    set_planes();
  }

  /// By a counting sort, so that the tetrahedra of a cube ascend.
  PointSearch make() {
    PointCubes& cubes = search_.cubes;
    auto& first = search_.first;
    first.assign(static_cast<std::size_t>(cubes.dims[0] * cubes.dims[1] * cubes.dims[2]) + 1, 0);
    visit_all([&](std::size_t cube, std::size_t) { ++first[cube + 1]; });
    for (std::size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
    search_.listed.resize(static_cast<std::size_t>(first.back()));
    std::vector<std::int64_t> next(first.begin(), first.end() - 1);
    visit_all([&](std::size_t cube, std::size_t t) {
      search_.listed[static_cast<std::size_t>(next[cube]++)] = static_cast<std::int32_t>(t);
    });
    return std::move(search_);
  }

 private:
  TetNodes nodes_of(std::size_t t) const {
    return tet_nodes({search_.rounded.data(), static_cast<std::int64_t>(search_.rounded.size())},
                     tets_[t].data());
  }

  /// The box of all tetrahedra. Throws when one is too large.
  void set_bounds() {
    PointCubes& cubes = search_.cubes;
    const QuantaBox box(nodes_of(0));
    std::copy_n(box.low.begin(), 3, cubes.low);
    std::copy_n(box.high.begin(), 3, cubes.high);
    for (std::size_t t = 0; t < tets_.size(); ++t) {
      const QuantaBox of_tet(nodes_of(t));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (of_tet.high[axis] - of_tet.low[axis] > longest_extent) {
          throw std::invalid_argument(
              "mesh: a cell spans over 2^20 voxels of the grid, that of "
              "tetrahedron " +
              std::to_string(t));
        }
        cubes.low[axis] = std::min(cubes.low[axis], of_tet.low[axis]);
        cubes.high[axis] = std::max(cubes.high[axis], of_tet.high[axis]);
      }
    }
    // Rounding of a plane value, which is a sum of four products, is below 2^-48 of this sum.
    cubes.margin = 0;
    for (int axis = 0; axis < 3; ++axis) cubes.margin += extent(axis);
    cubes.margin *= 0x1p-46;
  }

  double extent(int axis) const {
    return static_cast<double>(search_.cubes.high[axis] - search_.cubes.low[axis]);
  }

  void set_edge(double edge) {
    PointCubes& cubes = search_.cubes;
    cubes.per_edge = 1 / edge;
    for (int axis = 0; axis < 3; ++axis) {
      cubes.dims[axis] = cubes.place(cubes.high[axis], axis) + 1;
    }
  }

  /// Entries of the lists if all boxes were listed.
  double listed_boxes() const {
    double sum = 0;
    for (std::size_t t = 0; t < tets_.size(); ++t) {
      const QuantaBox box(nodes_of(t));
      double count = 1;
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        count *= static_cast<double>(search_.cubes.place(box.high[a], axis) -
                                     search_.cubes.place(box.low[a], axis) + 1);
      }
      sum += count;
    }
    return sum;
  }

  void choose_edge() {
    constexpr double cubes_per_tet = 2, most_along = 1024, most_listed_per_tet = 64;
    double volume = 1, longest = 1;
    for (int axis = 0; axis < 3; ++axis) {
      volume *= extent(axis) + 1;
      longest = std::max(longest, extent(axis));
    }
    const auto count = static_cast<double>(tets_.size());
    double edge = std::max(std::cbrt(volume / (cubes_per_tet * count)), longest / most_along);
    set_edge(edge);
    constexpr double few = 1e6;
    while (listed_boxes() > few + most_listed_per_tet * count && edge < longest) {
      edge *= 2;
      set_edge(edge);
    }
    edge_ = edge;
  }

  void set_planes() {
    search_.planes.resize(tets_.size());
    is_flat_.resize(tets_.size());
    for (std::size_t t = 0; t < tets_.size(); ++t) {
      const TetNodes tet = nodes_of(t);
      for (int face = 0; face < 4 && !is_flat_[t]; ++face) {
        ExactPlane<> exact = exact_plane(tet, face);
        is_flat_[t] = turn_inward(exact, tet, face) == 0;
        if (!is_flat_[t]) set_plane(exact, face, search_.planes[t]);
      }
    }
  }

  void set_plane(const ExactPlane<>& exact, int face, PointPlanes& planes) const {
    double square = 0;
    double* const normal = planes.normal[face];
    for (int axis = 0; axis < 3; ++axis) {
      normal[axis] = as_double(exact.normal[axis]);
      square += normal[axis] * normal[axis];
    }
    planes.at_low[face] = 0;
    for (int axis = 0; axis < 3; ++axis) {
      normal[axis] /= std::sqrt(square);
      planes.at_low[face] -=
          normal[axis] * static_cast<double>(exact.on[axis] - search_.cubes.low[axis]);
    }
  }

  /// Whether a tetrahedron may reach into the cube at `corner` [quantum from low]. Cubes are taken
  /// a little larger, for points that rounding moves across a side.
  bool may_reach(const PointPlanes& planes, const std::array<double, 3>& corner) const {
    constexpr double rim = 1e-9;
    for (int face = 0; face < 4; ++face) {
      const double* const n = planes.normal[face];
      double farthest = planes.at_low[face] + search_.cubes.margin + 1 + rim * edge_;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        farthest += n[axis] * (corner[axis] + (n[axis] > 0 ? edge_ : 0));
      }
      if (farthest < 0) return false;
    }
    return true;
  }

  /// visit(cube, t) for every cube that tetrahedron t may reach into, in the order of t.
  template <class Visit>
  void visit_all(const Visit& visit) const {
    for (std::size_t t = 0; t < tets_.size(); ++t) {
      if (!is_flat_[t]) visit_cubes(t, visit);
    }
  }
  template <class Visit>
  void visit_cubes(std::size_t t, const Visit& visit) const {
    const PointCubes& cubes = search_.cubes;
    const QuantaBox box(nodes_of(t));
    std::int64_t from[3], to[3];
    for (int axis = 0; axis < 3; ++axis) {
      from[axis] = cubes.place(box.low[static_cast<std::size_t>(axis)], axis);
      to[axis] = cubes.place(box.high[static_cast<std::size_t>(axis)], axis);
    }
    for (std::int64_t k = from[2]; k <= to[2]; ++k) {
      for (std::int64_t j = from[1]; j <= to[1]; ++j) {
        for (std::int64_t i = from[0]; i <= to[0]; ++i) {
          const std::array<double, 3> corner{static_cast<double>(i) * edge_,
                                             static_cast<double>(j) * edge_,
                                             static_cast<double>(k) * edge_};
          if (may_reach(search_.planes[t], corner)) {
            visit(static_cast<std::size_t>(cubes.cube_at(i, j, k)), t);
          }
        }
      }
    }
  }

  const Tets& tets_;
  PointSearch search_{};
  double edge_ = 1;  // of a cube [quantum]
  std::vector<bool> is_flat_;
};
}  // namespace

PointSearch make_point_search(const IndexFromWorld& map,
                              const std::vector<Point3>& nodes,
                              const Tets& tets) {
  return SearchMaker(map, nodes, tets).make();
}

}  // namespace tetwarp
