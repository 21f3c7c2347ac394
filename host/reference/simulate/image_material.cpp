/// @file image_material.cpp
/// Searches the owner of every voxel, cuts tetrahedra at voxels, and looks materials up by value.
#include "host/reference/simulate/image_material.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/pixel_dispatch.hpp"

namespace tetwarp::reference {
namespace {

__extension__ using Wide = __int128;
using Lattice3 = std::array<std::int64_t, 3>;
constexpr double quanta_per_voxel = 1048576;
constexpr double smallest_share = 1e-10;  // of the tetrahedron or the voxel; less is rounding

/// Six times the signed volume of four points.
Wide volume_of(const std::array<Lattice3, 4>& p) {
  std::array<std::array<Wide, 3>, 3> e;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) e[row][axis] = p[row + 1][axis] - p[0][axis];
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
         e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

bool contains(const std::array<Lattice3, 4>& tet, const Lattice3& x) {
  const Wide whole = volume_of(tet);
  if (whole == 0) return false;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    auto part = tet;
    part[corner] = x;
    const Wide volume = volume_of(part);
    if (volume != 0 && (volume > 0) != (whole > 0)) return false;
  }
  return true;
}

Matrix3d world_from_index(const Grid& grid) {
  Matrix3d m;
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) {
      m(row, axis) = grid.direction[static_cast<std::size_t>(3 * row + axis)] *
                     grid.spacing[static_cast<std::size_t>(axis)];
    }
  }
  return m;
}

/// With all digits, also those of 64-bit integers.
long double sample_at(const Volume& volume, const Lattice3& ijk) {
  const auto& dims = volume.grid.dims;
  const std::int64_t voxel = ijk[0] + dims[0] * (ijk[1] + dims[1] * ijk[2]);
  long double value = 0;
  with_pixel_type(volume.type, [&](auto zero) {
    using T = decltype(zero);
    value = static_cast<long double>(
        volume.samples<T>()[static_cast<std::size_t>(voxel * volume.components)]);
  });
  return value;
}

Lattice3 rounded(const Vector3d& v) {
  Lattice3 result;
  for (int axis = 0; axis < 3; ++axis) {
    result[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::nearbyint(v(axis)));
  }
  return result;
}

/// N_0 to N_3 of a tetrahedron at a point.
Eigen::Vector4d shape_at(const std::array<Vector3d, 4>& tet, const Vector3d& x) {
  Matrix3d edges;
  edges << tet[1] - tet[0], tet[2] - tet[0], tet[3] - tet[0];
  Eigen::Vector4d shape;
  shape.tail<3>() = edges.inverse() * (x - tet[0]);
  shape(0) = 1 - shape.tail<3>().sum();
  return shape;
}

/// A part of a tetrahedron: four corners, each with its N_0 to N_3 and its index position.
struct Piece {
  std::array<Eigen::Vector4d, 4> shape;
  std::array<Vector3d, 4> x;

  double volume() const { return std::abs((x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0])) / 6; }
};

/// Cuts pieces at the plane x(axis) = place: those below, and those above.
std::array<std::vector<Piece>, 2> cut(const std::vector<Piece>& pieces, int axis, double place) {
  std::array<std::vector<Piece>, 2> sides;
  for (const Piece& piece : pieces) {
    std::array<std::vector<std::size_t>, 2> of;  // corners below, above
    for (std::size_t c = 0; c < 4; ++c) of[piece.x[c](axis) > place ? 1 : 0].push_back(c);
    for (std::size_t side = 0; side < 2; ++side) {
      const auto &in = of[side], &out = of[1 - side];
      // The corners of the part on this side, in an order in which four in turn are a tetrahedron.
      std::vector<std::array<std::size_t, 2>> corners;  // the same twice, or an edge that is cut
      if (out.empty()) {
        for (const std::size_t i : in) corners.push_back({i, i});
      } else if (in.size() == 1) {
        corners.push_back({in[0], in[0]});
        for (const std::size_t o : out) corners.push_back({in[0], o});
      } else if (in.size() == 2) {
        for (const std::size_t i : in) {
          corners.push_back({i, i});
          for (const std::size_t o : out) corners.push_back({i, o});
        }
      } else if (in.size() == 3) {
        for (const std::size_t i : in) corners.push_back({i, i});
        for (const std::size_t i : in) corners.push_back({i, out[0]});
      }
      for (std::size_t first = 0; first + 3 < corners.size(); ++first) {
        Piece& part = sides[side].emplace_back();
        for (std::size_t c = 0; c < 4; ++c) {
          const auto [a, b] = corners[first + c];
          const double way = piece.x[b](axis) - piece.x[a](axis);
          const double u = a == b ? 0 : (place - piece.x[a](axis)) / way;
          part.x[c] = piece.x[a] + u * (piece.x[b] - piece.x[a]);
          part.shape[c] = piece.shape[a] + u * (piece.shape[b] - piece.shape[a]);
        }
      }
    }
  }
  return sides;
}

/// Integrals of a tetrahedron over pieces of one voxel.
HeldVoxel held_by(const std::vector<Piece>& pieces) {
  HeldVoxel held;
  held.products.setZero();
  for (const Piece& piece : pieces) {
    const double volume = piece.volume();
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (const Eigen::Vector4d& shape : piece.shape) {
      sum += shape;
      held.products += volume / 20 * shape * shape.transpose();
    }
    held.products += volume / 20 * sum * sum.transpose();
    held.share += volume;
  }
  return held;
}

/// Calls work(voxel, pieces) for the slabs of voxels along an axis and all later axes.
template <class Work>
void cut_at_voxels(std::vector<Piece> pieces, int axis, Lattice3& voxel, const Work& work) {
  if (axis == 3) return work(voxel, pieces);
  double low = INFINITY, high = -INFINITY;
  for (const Piece& piece : pieces) {
    for (const Vector3d& x : piece.x) {
      low = std::min(low, x(axis));
      high = std::max(high, x(axis));
    }
  }
  std::int64_t& place = voxel[static_cast<std::size_t>(axis)];
  const auto first = static_cast<std::int64_t>(std::floor(low + 0.5));
  const auto last = static_cast<std::int64_t>(std::floor(high + 0.5));
  for (std::int64_t at = first; at <= last && !pieces.empty(); ++at) {
    auto [below, above] = cut(pieces, axis, static_cast<double>(at) + 0.5);
    place = at;
    if (!below.empty()) cut_at_voxels(std::move(below), axis + 1, voxel, work);
    pieces = std::move(above);
  }
}

}  // namespace

std::vector<std::vector<HeldVoxel>> owned_voxels(
    const ImageGeometry& image,
    const std::vector<Point3>& nodes,
    const std::vector<std::array<std::int32_t, 4>>& tets) {
  const Grid& grid = image.volume.grid;
  const Matrix3d from_world = world_from_index(grid).inverse();
  const Vector3d origin = vector_of(grid.origin);
  std::vector<bool> is_owned(static_cast<std::size_t>(grid.voxel_count()));
  std::vector<std::vector<HeldVoxel>> owned(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    std::array<Lattice3, 4> corners;
    std::array<Vector3d, 4> tet;
    Lattice3 first = grid.dims, last{-1, -1, -1};
    for (std::size_t a = 0; a < 4; ++a) {
      const Vector3d node = vector_of(nodes[static_cast<std::size_t>(tets[t][a])]);
      const Vector3d index = from_world * (node - origin);
      corners[a] = rounded(index * quanta_per_voxel);
      tet[a] = index;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double place = index(static_cast<Eigen::Index>(axis));
        const auto below = static_cast<std::int64_t>(std::floor(place)) - 1;
        first[axis] = std::min(first[axis], std::max(below, std::int64_t{0}));
        last[axis] = std::max(last[axis], std::min(below + 3, grid.dims[axis] - 1));
      }
    }
    Lattice3 ijk;
    for (ijk[2] = first[2]; ijk[2] <= last[2]; ++ijk[2]) {
      for (ijk[1] = first[1]; ijk[1] <= last[1]; ++ijk[1]) {
        for (ijk[0] = first[0]; ijk[0] <= last[0]; ++ijk[0]) {
          const auto voxel =
              static_cast<std::size_t>(ijk[0] + grid.dims[0] * (ijk[1] + grid.dims[1] * ijk[2]));
          if (is_owned[voxel]) continue;
          const Lattice3 center{ijk[0] << 20, ijk[1] << 20, ijk[2] << 20};
          if (!contains(corners, center)) continue;
          is_owned[voxel] = true;
          const long double value = sample_at(image.volume, ijk);
          if (!(value >= image.threshold)) continue;
          const Vector3d index(static_cast<double>(ijk[0]), static_cast<double>(ijk[1]),
                               static_cast<double>(ijk[2]));
          const Eigen::Vector4d shape = shape_at(tet, index);
          owned[t].push_back({static_cast<double>(value), 1, shape * shape.transpose()});
        }
      }
    }
  }
  return owned;
}

std::vector<std::vector<HeldVoxel>> shared_voxels(
    const ImageGeometry& image,
    const std::vector<Point3>& nodes,
    const std::vector<std::array<std::int32_t, 4>>& tets) {
  const Grid& grid = image.volume.grid;
  const Matrix3d from_world = world_from_index(grid).inverse();
  std::vector<std::vector<HeldVoxel>> shared(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    Piece whole;
    for (std::size_t a = 0; a < 4; ++a) {
      const Vector3d node = vector_of(nodes[static_cast<std::size_t>(tets[t][a])]);
      whole.x[a] = from_world * (node - vector_of(grid.origin));
      whole.shape[a] = Eigen::Vector4d::Unit(static_cast<Eigen::Index>(a));
    }
    Lattice3 voxel{};
    cut_at_voxels({whole}, 0, voxel, [&](const Lattice3& ijk, const std::vector<Piece>& pieces) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (ijk[axis] < 0 || ijk[axis] >= grid.dims[axis]) return;
      }
      const long double value = sample_at(image.volume, ijk);
      if (!(value >= image.threshold)) return;
      HeldVoxel held = held_by(pieces);
      if (held.share <= smallest_share * std::min(whole.volume(), 1.0)) return;
      held.value = static_cast<double>(value);
      shared[t].push_back(held);
    });
  }
  return shared;
}

std::optional<Material> material_at(const Body& body, double value) {
  if (body.transfer.empty()) return body.material;
  const auto& table = body.transfer;
  if (body.lookup == TransferLookup::label) {
    for (const TransferPoint& entry : table) {
      if (entry.value == value) return entry.material;
    }
    return std::nullopt;
  }
  if (value <= table.front().value) return table.front().material;
  if (value >= table.back().value) return table.back().material;
  std::size_t next = 1;
  while (table[next].value < value) ++next;
  const TransferPoint &a = table[next - 1], &b = table[next];
  const double u = (value - a.value) / (b.value - a.value);
  const auto between = [u](double from, double to) { return from + u * (to - from); };
  return Material{between(a.material.youngs_modulus, b.material.youngs_modulus),
                  between(a.material.poissons_ratio, b.material.poissons_ratio),
                  between(a.material.density, b.material.density)};
}

}  // namespace tetwarp::reference
