/// @file marching_tets.cpp
/// Triangles of one tetrahedron, and points that neighbors share.
#include "host/scene/marching_tets.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "host/base/five_tets.hpp"
#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
/// A corner of a triangle: the lattice edge that it is on.
struct Corner {
  std::int64_t inside, outside;  ///< numbers of lattice nodes
  double t;
  bool operator<(const Corner& other) const {
    return std::pair(inside, outside) < std::pair(other.inside, other.outside);
  }
  bool is_same_edge(const Corner& other) const {
    return inside == other.inside && outside == other.outside;
  }
};

/// Planes of levels, two at a time.
using ReadPlane = std::function<void(std::int64_t, std::vector<double>&)>;

/// Calls visit_tet(corners, level, node) for all tetrahedra of boxes that the surface crosses, and
/// end_layer() after each layer of boxes.
template <class VisitTet, class EndLayer>
void visit_tets(const std::array<std::int64_t, 3>& counts,
                const ReadPlane& read_plane,
                const VisitTet& visit_tet,
                const EndLayer& end_layer) {
  const auto plane_size = static_cast<std::size_t>(counts[0] * counts[1]);
  std::vector<double> lower(plane_size), upper(plane_size);
  std::array<double, 8> level;
  std::array<std::int64_t, 8> node;
  read_plane(0, upper);
  for (std::int64_t c = 0; c + 1 < counts[2]; ++c) {
    std::swap(lower, upper);
    read_plane(c + 1, upper);
    for (std::int64_t b = 0; b + 1 < counts[1]; ++b) {
      for (std::int64_t a = 0; a + 1 < counts[0]; ++a) {
        int inside_count = 0;
        for (std::size_t corner = 0; corner < 8; ++corner) {
          const auto place = static_cast<std::size_t>(
              (b + static_cast<std::int64_t>(corner >> 1 & 1)) * counts[0] + a +
              static_cast<std::int64_t>(corner & 1));
          const bool is_upper = corner >= 4;
          level[corner] = (is_upper ? upper : lower)[place];
          node[corner] = (c + is_upper) * counts[0] * counts[1] + static_cast<std::int64_t>(place);
          inside_count += level[corner] >= 0;
        }
        if (inside_count == 0 || inside_count == 8) continue;
        for (const auto& corners : tets_of_cell[(a + b + c) % 2]) visit_tet(corners, level, node);
      }
    }
    end_layer();
  }
}

int inside_of(const int (&tet)[4], const std::array<double, 8>& level) {
  int inside = 0;
  for (const int corner : tet) inside += level[static_cast<std::size_t>(corner)] >= 0;
  return inside;
}

class March {
 public:
  std::vector<Corner> corners;  ///< three per triangle

  void add_tet(const int (&tet)[4],
               const std::array<double, 8>& level,
               const std::array<std::int64_t, 8>& node) {
    // Nodes inside first; an even permutation keeps the volume positive.
    std::array<std::size_t, 4> order{};
    std::size_t next = 0;
    const int inside = inside_of(tet, level);
    if (inside == 0 || inside == 4) return;
    int swaps = 0, outside_before = 0;
    for (const int corner : tet) {
      if (level[static_cast<std::size_t>(corner)] < 0) {
        ++outside_before;
      } else {
        order[next++] = static_cast<std::size_t>(corner);
        swaps += outside_before;
      }
    }
    for (const int corner : tet) {
      if (level[static_cast<std::size_t>(corner)] < 0)
        order[next++] = static_cast<std::size_t>(corner);
    }
    if (swaps % 2 != 0) {
      if (inside == 1) {
        std::swap(order[2], order[3]);
      } else {
        std::swap(order[0], order[1]);
      }
    }
    const auto cut = [&](std::size_t in, std::size_t out) {
      const std::size_t i = order[in], o = order[out];
      return Corner{node[i], node[o], level[i] / (level[i] - level[o])};
    };
    if (inside == 1) add(cut(0, 1), cut(0, 2), cut(0, 3));
    if (inside == 3) add(cut(0, 3), cut(1, 3), cut(2, 3));
    if (inside == 2) {
      add(cut(0, 2), cut(0, 3), cut(1, 3));
      add(cut(0, 2), cut(1, 3), cut(1, 2));
    }
  }

 private:
  void add(const Corner& a, const Corner& b, const Corner& c) {
    corners.insert(corners.end(), {a, b, c});
  }
};

MarchedSurface joined(const std::vector<Corner>& corners,
                      const std::array<std::int64_t, 3>& counts) {
  std::vector<Corner> edges = corners;
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end(),
                          [](const Corner& a, const Corner& b) { return a.is_same_edge(b); }),
              edges.end());
  const auto abc_of = [&](std::int64_t node) {
    return std::array<std::int64_t, 3>{node % counts[0], node / counts[0] % counts[1],
                                       node / counts[0] / counts[1]};
  };
  MarchedSurface surface;
  surface.cuts.reserve(edges.size());
  for (const Corner& edge : edges) {
    surface.cuts.push_back({abc_of(edge.inside), abc_of(edge.outside), edge.t});
  }
  surface.triangles.resize(corners.size() / 3);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const auto found = std::lower_bound(edges.begin(), edges.end(), corners[c]);
    surface.triangles[c / 3][c % 3] = static_cast<std::int32_t>(found - edges.begin());
  }
  return surface;
}
}  // namespace

MarchedSurface march_tets(const std::string& place,
                          const std::array<std::int64_t, 3>& counts,
                          const ReadPlane& read_plane) {
  March march;
  visit_tets(
      counts, read_plane,
      [&](const auto& tet, const auto& level, const auto& node) {
        march.add_tet(tet, level, node);
      },
      [&] {
        if (march.corners.size() < (std::size_t{1} << 31)) return;
        fail_at(place, "its isosurface has 2^31 / 3 or more triangles; give surface.triangles");
      });
  return joined(march.corners, counts);
}

std::int64_t count_marched(const std::array<std::int64_t, 3>& counts, const ReadPlane& read_plane) {
  constexpr std::array<std::int64_t, 5> triangles{0, 1, 2, 1, 0};  // by corners inside
  std::int64_t count = 0;
  visit_tets(
      counts, read_plane,
      [&](const auto& tet, const auto& level, const auto&) {
        count += triangles[static_cast<std::size_t>(inside_of(tet, level))];
      },
      [] {});
  return count;
}

}  // namespace tetwarp
