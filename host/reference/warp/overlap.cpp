/// @file overlap.cpp
/// Clips tetrahedra by the planes of boxes, and sums the volumes of the parts.
#include "host/reference/warp/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace tetwarp::reference {
namespace {
using Simplex = std::array<Eigen::Vector3d, 4>;

/// A tetrahedron with positions in voxels.
Simplex simplex_of(const Corners& tet) {
  Simplex simplex;
  for (std::size_t node = 0; node < 4; ++node) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      simplex[node](static_cast<Eigen::Index>(axis)) =
          static_cast<double>(tet[node][axis]) / one_voxel;
    }
  }
  return simplex;
}

/// The parts of simplices where normal . x >= offset, as simplices.
std::vector<Simplex> cut(const std::vector<Simplex>& simplices,
                         const Eigen::Vector3d& normal,
                         double offset) {
  std::vector<Simplex> kept;
  for (const Simplex& simplex : simplices) {
    std::vector<Eigen::Vector3d> in, out;
    for (const Eigen::Vector3d& x : simplex) (normal.dot(x) >= offset ? in : out).push_back(x);
    const auto between = [&](std::size_t i, std::size_t o) {
      const double above = normal.dot(in[i]) - offset, below = offset - normal.dot(out[o]);
      return Eigen::Vector3d(in[i] + above / (above + below) * (out[o] - in[i]));
    };
    std::vector<Eigen::Vector3d> prism;  // two triangles, with corresponding corners
    if (out.empty()) {
      kept.push_back(simplex);
    } else if (in.size() == 1) {
      kept.push_back({in[0], between(0, 0), between(0, 1), between(0, 2)});
    } else if (in.size() == 2) {
      prism = {in[0], between(0, 0), between(0, 1), in[1], between(1, 0), between(1, 1)};
    } else if (in.size() == 3) {
      prism = {in[0], in[1], in[2], between(0, 0), between(1, 0), between(2, 0)};
    }
    for (std::size_t first = 0; first < 3 && !prism.empty(); ++first) {
      kept.push_back({prism[first], prism[first + 1], prism[first + 2], prism[first + 3]});
    }
  }
  return kept;
}

/// The parts of simplices in the box of the voxel at `center`.
std::vector<Simplex> in_box(std::vector<Simplex> simplices, const Eigen::Vector3d& center) {
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d normal = Eigen::Vector3d::Unit(axis);
    simplices = cut(simplices, normal, center(axis) - 0.5);
    simplices = cut(simplices, -normal, -center(axis) - 0.5);
  }
  return simplices;
}

double volume_of(const std::vector<Simplex>& simplices) {
  double volume = 0;
  for (const Simplex& s : simplices) {
    volume += std::abs((s[1] - s[0]).cross(s[2] - s[0]).dot(s[3] - s[0])) / 6;
  }
  return volume;
}

/// Calls work(voxel, pieces) for the voxels whose boxes overlap the simplices.
template <class Work>
void for_boxes(const std::vector<Simplex>& simplices, const Dims& dims, const Work& work) {
  std::int64_t first[3], last[3];
  for (int axis = 0; axis < 3; ++axis) {
    double low = INFINITY, high = -INFINITY;
    for (const Simplex& simplex : simplices) {
      for (const Eigen::Vector3d& x : simplex) {
        low = std::min(low, x(axis));
        high = std::max(high, x(axis));
      }
    }
    const auto end = static_cast<double>(dims[static_cast<std::size_t>(axis)]);
    first[axis] = static_cast<std::int64_t>(std::clamp(std::floor(low + 0.5), 0.0, end));
    last[axis] = static_cast<std::int64_t>(std::clamp(std::floor(high + 0.5), -1.0, end - 1));
  }
  for (std::int64_t k = first[2]; k <= last[2]; ++k) {
    for (std::int64_t j = first[1]; j <= last[1]; ++j) {
      for (std::int64_t i = first[0]; i <= last[0]; ++i) {
        const Eigen::Vector3d center(static_cast<double>(i), static_cast<double>(j),
                                     static_cast<double>(k));
        const std::vector<Simplex> pieces = in_box(simplices, center);
        if (!pieces.empty()) work((k * dims[1] + j) * dims[0] + i, pieces);
      }
    }
  }
}

Eigen::Matrix3d edges_of(const Simplex& s) {
  Eigen::Matrix3d edges;
  edges << s[1] - s[0], s[2] - s[0], s[3] - s[0];
  return edges;
}
}  // namespace

void for_held(const Corners& rest, const Dims& source, const VisitHeld& visit) {
  for_boxes({simplex_of(rest)}, source, [&](std::int64_t from, const std::vector<Simplex>& parts) {
    visit(from, volume_of(parts));
  });
}

void for_overlaps(const Corners& rest,
                  const Corners& now,
                  const Dims& source,
                  const Dims& output,
                  const Visit& visit) {
  const Simplex from = simplex_of(rest), to = simplex_of(now);
  const Eigen::Matrix3d map = edges_of(from) * edges_of(to).inverse();
  for_boxes({to}, output, [&](std::int64_t voxel, std::vector<Simplex> pieces) {
    for (Simplex& piece : pieces) {
      for (Eigen::Vector3d& x : piece) x = from[0] + map * (x - to[0]);
    }
    for_boxes(pieces, source, [&](std::int64_t origin, const std::vector<Simplex>& parts) {
      visit(voxel, origin, volume_of(parts));
    });
  });
}

std::vector<double> elected(const std::function<double(std::int64_t)>& label_of,
                            const Dims& source,
                            const std::vector<MovedTet>& tets,
                            const Region& region,
                            double background) {
  Dims dims;
  for (std::size_t axis = 0; axis < 3; ++axis) dims[axis] = region.end[axis] - region.begin[axis];
  std::vector<std::map<double, double>> shares(static_cast<std::size_t>(region.voxel_count()));
  for (auto [rest, now] : tets) {
    const auto at_rest = static_cast<double>(signed_volume(rest));
    const auto deformed = static_cast<double>(signed_volume(now));
    if (at_rest == 0 || deformed == 0) continue;
    for (Quanta& node : now) {
      for (std::size_t axis = 0; axis < 3; ++axis) node[axis] -= region.begin[axis] * one_voxel_int;
    }
    for_overlaps(rest, now, source, dims,
                 [&](std::int64_t voxel, std::int64_t from, double volume) {
                   shares[static_cast<std::size_t>(voxel)][label_of(from)] +=
                       volume * std::abs(deformed / at_rest);
                 });
  }
  std::vector<double> labels(shares.size(), background);
  for (std::size_t v = 0; v < shares.size(); ++v) {
    double covered = 0, most = -1;  // below all shares
    for (const auto& [label, share] : shares[v]) covered += share;
    shares[v][background] += std::max(0.0, 1 - covered);
    for (const auto& [label, share] : shares[v]) {
      if (share <= most + 0x1p-16) continue;
      most = share;
      labels[v] = label;
    }
  }
  return labels;
}

}  // namespace tetwarp::reference
