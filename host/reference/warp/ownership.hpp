/// @file ownership.hpp
/// The owner of each voxel and the rest position of its material, straight from the definition: all
/// voxels in the bounding box of every tetrahedron, by determinants in exact integers, serially.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tetwarp/error.hpp>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "host/reference/warp/curved_tetrahedron.hpp"
#include "host/reference/warp/exact_geometry.hpp"
#include "host/reference/warp/fields.hpp"
#include "host/reference/warp/hexahedron.hpp"

namespace tetwarp::reference {

class Ownership {
 public:
  /// The plan must outlive it.
  explicit Ownership(const WarpPlan& plan)
      : output(plan.output_grid), source(plan.sources.front().grid), plan_(plan) {}

  /// Computes owner, source_position and strictly_inside, and adds to `counts`.
  /// @throws Cancelled when `progress` returns false
  void claim_all(const double* rest,
                 const double* deformed,
                 Counts& counts,
                 const Progress& progress) {
    const auto voxels = static_cast<std::size_t>(plan_.target_grid.voxel_count());
    owner.assign(voxels, -1);
    source_position.assign(voxels, Eigen::Vector3d::Zero());
    strictly_inside.assign(plan_.options.count_folded ? voxels : 0, 0);
    const auto tets = static_cast<std::int32_t>(plan_.mesh.tets.size());
    for (std::int32_t t = 0; t < tets; ++t) {
      claim(t, rest, deformed, counts);
      if (progress && t % 64 == 0 && !progress(0.5 * t / tets)) throw Cancelled();
    }
  }

  Corners corners_of(std::int32_t t, const double* positions, const IndexSpace& space) const {
    Corners corners;
    for (std::size_t node = 0; node < 4; ++node) {
      const auto n = static_cast<std::size_t>(plan_.mesh.tets[static_cast<std::size_t>(t)][node]);
      corners[node] = space.quanta_of(positions + 3 * n);
    }
    return corners;
  }

  /// The maps of a hexahedron from local coordinates to deformed and rest positions.
  struct Hexahedron {
    Trilinear now;
    Trilinear rest;
    std::optional<Eigen::Vector3d> shift;  ///< see whole_shift()
  };
  /// The hexahedron that tetrahedron t is a part of, if any.
  std::optional<Hexahedron> hexahedron_of(std::int32_t t,
                                          const double* rest_positions,
                                          const double* deformed) const {
    if (t < lone_tets()) return std::nullopt;
    const auto h = static_cast<std::size_t>(cell_of(t) - lone_tets());
    HexCorners now, rest;
    for (std::size_t node = 0; node < 8; ++node) {
      const auto n = static_cast<std::size_t>(plan_.mesh.hexes[h][node]);
      now[node] = output.quanta_of(deformed + 3 * n);
      rest[node] = source.quanta_of(rest_positions + 3 * n);
    }
    return Hexahedron{Trilinear(now), Trilinear(rest), whole_shift(rest, now)};
  }

  /// The quadratic maps of tetrahedron t, if it has ten nodes and they differ from those of its
  /// corners.
  struct Curve {
    QuadraticTetrahedron now;
    QuadraticTetrahedron rest;
    bool is_lost = false;  ///< a middle node is too far from the grid

    /// As QuadraticTetrahedron::inverse(), of the deformed cell.
    std::optional<Eigen::Vector4d> inverse(const Eigen::Vector3d& x,
                                           const Eigen::Vector4d& straight) const {
      return is_lost ? std::nullopt : now.inverse(x, straight);
    }
  };
  std::optional<Curve> curve_of(std::int32_t t,
                                const double* rest_positions,
                                const double* deformed) const {
    const auto tet = static_cast<std::size_t>(t);
    if (tet >= plan_.mid_nodes.size() || plan_.mid_nodes[tet] == no_mid_nodes) return std::nullopt;
    TenQuanta now, rest{};
    for (std::size_t n = 0; n < 10; ++n) {
      const auto node =
          static_cast<std::size_t>(n < 4 ? plan_.mesh.tets[tet][n] : plan_.mid_nodes[tet][n - 4]);
      const std::optional<Quanta> moved = output.quanta_if_near(deformed + 3 * node);
      rest[n] = source.quanta_of(rest_positions + 3 * node);
      if (!moved) return Curve{QuadraticTetrahedron(rest), QuadraticTetrahedron(rest), true};
      now[n] = *moved;
    }
    if (has_straight_edges(now) && has_straight_edges(rest)) return std::nullopt;
    if (whole_shift(rest, now)) return std::nullopt;
    return Curve{QuadraticTetrahedron(now), QuadraticTetrahedron(rest)};
  }

  /// F = d deformed / d rest at a voxel that tetrahedron t owns, in world axes.
  Eigen::Matrix3d gradient(std::int32_t t,
                           const Eigen::Vector3d& voxel,
                           const double* rest,
                           const double* deformed) const {
    if (const auto hex = hexahedron_of(t, rest, deformed)) {
      const Eigen::Vector3d u = hex->now.inverse(voxel);
      return output.to_world * hex->now.gradient(u) *
             (source.to_world * hex->rest.gradient(u)).inverse();
    }
    const Corners now = corners_of(t, deformed, output);
    if (const auto curved = curve_of(t, rest, deformed)) {
      if (const auto l = curved->inverse(voxel, weights_of(now, voxel))) {
        return output.to_world * curved->now.gradient(*l) *
               (source.to_world * curved->rest.gradient(*l)).inverse();
      }
    }
    return gradient_of(corners_of(t, rest, source), source, now, output);
  }

  /// Number of the cell that tetrahedron t is or is a part of.
  std::int32_t cell_of(std::int32_t t) const {
    return t < lone_tets() ? t : lone_tets() + (t - lone_tets()) / 6;
  }

  IndexSpace output;
  IndexSpace source;
  std::vector<std::int32_t> owner;               ///< tetrahedron of each voxel, or -1
  std::vector<Eigen::Vector3d> source_position;  ///< of covered voxels [source voxel]
  std::vector<std::uint8_t> strictly_inside;     ///< number of tetrahedra that strictly contain the
                                                 ///< voxel, at most 2; empty: not counted

 private:
  /// Assigns to tetrahedron t the voxels of its closed shape that no lower tetrahedron owns.
  void claim(std::int32_t t, const double* rest_positions, const double* deformed, Counts& counts) {
    const Corners now = corners_of(t, deformed, output);
    const Corners rest = corners_of(t, rest_positions, source);
    check_extent(now);
    check_extent(rest);
    const Integer volume = signed_volume(now);
    if (volume == 0) {
      ++counts.flat;
      return;
    }
    const bool mirrored = output.to_world.determinant() * source.to_world.determinant() < 0;
    const Integer rest_volume = mirrored ? -signed_volume(rest) : signed_volume(rest);
    counts.inverted += (volume > 0 && rest_volume < 0) || (volume < 0 && rest_volume > 0);

    const std::optional<Hexahedron> hex = hexahedron_of(t, rest_positions, deformed);
    const std::optional<Curve> curve = curve_of(t, rest_positions, deformed);
    const std::optional<Eigen::Vector3d> shift = hex ? hex->shift : whole_shift(rest, now);
    const Region box = box_of(now);
    for (std::int64_t k = box.begin[2]; k < box.end[2]; ++k) {
      for (std::int64_t j = box.begin[1]; j < box.end[1]; ++j) {
        for (std::int64_t i = box.begin[0]; i < box.end[0]; ++i) {
          ++counts.inside_tests;
          const std::optional<Barycentric> b =
              barycentric_of(now, {i * one_voxel_int, j * one_voxel_int, k * one_voxel_int});
          if (!b) continue;
          const std::size_t v = voxel_at(i, j, k);
          if (!strictly_inside.empty() && !b->on_face && strictly_inside[v] < 2) {
            ++strictly_inside[v];
          }
          if (owner[v] >= 0) continue;
          owner[v] = t;
          const Eigen::Vector3d x(static_cast<double>(i), static_cast<double>(j),
                                  static_cast<double>(k));
          const std::optional<Eigen::Vector4d> l =
              curve ? curve->inverse(x, b->weight) : std::nullopt;
          counts.voxels_straightened += curve && !l;
          if (l) {
            source_position[v] = curve->rest.at(*l);
          } else if (shift) {
            source_position[v] = x + *shift;
          } else if (hex) {
            source_position[v] = hex->rest.at(hex->now.inverse(x));
          } else {
            source_position[v] = combined(rest, b->weight);
          }
        }
      }
    }
  }

  /// Voxels of the region in the bounding box of a tetrahedron.
  Region box_of(const Corners& now) const {
    Region box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::int64_t low = now[0][axis], high = low;
      for (const Quanta& node : now) {
        low = std::min(low, node[axis]);
        high = std::max(high, node[axis]);
      }
      const auto first = static_cast<std::int64_t>(std::ceil(static_cast<double>(low) / one_voxel));
      const auto last =
          static_cast<std::int64_t>(std::floor(static_cast<double>(high) / one_voxel));
      box.begin[axis] = std::max(first, plan_.region.begin[axis]);
      box.end[axis] = std::min(last + 1, plan_.region.end[axis]);
    }
    return box;
  }

  /// Tetrahedra that are not parts of hexahedra; they come first.
  std::int32_t lone_tets() const {
    return static_cast<std::int32_t>(plan_.mesh.tets.size() - 6 * plan_.mesh.hexes.size());
  }

  /// Barycentric coordinates of a voxel that the tetrahedron owns.
  static Eigen::Vector4d weights_of(const Corners& tet, const Eigen::Vector3d& voxel) {
    Quanta x;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      x[axis] = std::llround(voxel(static_cast<Eigen::Index>(axis))) * one_voxel_int;
    }
    return barycentric_of(tet, x)->weight;
  }

  /// sum_i weight_i rest_i [voxel]
  static Eigen::Vector3d combined(const Corners& rest, const Eigen::Vector4d& weight) {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (std::size_t node = 0; node < 4; ++node) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        x(static_cast<Eigen::Index>(axis)) += weight(static_cast<Eigen::Index>(node)) *
                                              (static_cast<double>(rest[node][axis]) / one_voxel);
      }
    }
    return x;
  }

  std::size_t voxel_at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const Region& r = plan_.region;
    const std::array<std::int64_t, 3>& n = plan_.target_grid.dims;
    return static_cast<std::size_t>(((k - r.begin[2]) * n[1] + (j - r.begin[1])) * n[0] +
                                    (i - r.begin[0]));
  }

  const WarpPlan& plan_;
};

}  // namespace tetwarp::reference
