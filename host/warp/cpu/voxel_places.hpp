/// @file voxel_places.hpp
/// Where each voxel of an output grid has its sample in the source, in float64.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/warp/cpu/operator_taps.hpp"
#include "host/warp/geometry.hpp"
#include "kernels/warp/hex_map.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Owners and maps of one deformation, those of a Warper.
class VoxelPlaces {
 public:
  /// @param plan  of operator_plan()
  /// @param mask  as WarpOperatorOptions::mask
  /// @throws std::invalid_argument  on wrong positions
  VoxelPlaces(const WarpPlan& plan,
              const std::vector<Point3>& deformed,
              const std::vector<std::uint8_t>& mask,
              int threads);
  VoxelPlaces(VoxelPlaces&&) = delete;  // views refer to members

  const Grid& source_grid() const { return source_; }
  const Grid& output_grid() const { return output_; }
  std::int64_t row_count() const { return output_.dims[1] * output_.dims[2]; }
  std::int64_t tet_count() const { return std::ssize(mesh_.tets); }
  std::int64_t node_count() const { return std::ssize(nodes_); }
  /// Index positions of the output by world positions, without the origin.
  const Matrix3& index_from_world() const { return geometry_.axes.output_index; }

  /// Calls visit(voxel, place) for all voxels of a row along i that have a place.
  template <class Visit>
  void for_row(std::int64_t row, const Visit& visit) const {
    int x[3];
    geometry_.frame.set_row_start(row, x);
    std::int64_t voxel = row * output_.dims[0];
    HexCache cache;
    for (; x[0] < output_.dims[0]; ++x[0], ++voxel) {
      const std::int32_t owner = owners_[static_cast<std::size_t>(voxel)];
      SourcePlace place;
      if (owner >= 0) {
        set_place(owner, x, cache, place);
      } else if (owner == uncovered && geometry_.outside.use_source) {
        double start[3];
        outside_start(geometry_.outside, x, start);
        split(start, place);
      } else {
        continue;
      }
      visit(voxel, place);
    }
  }

  /// How a voxel's place depends on the nodes of its cell: it moves by the matrix `backward` times
  /// minus the mean of their motions by `weight` [voxel of the output].
  struct Dependence {
    std::size_t count;  ///< 4, or 8 of a hexahedron
    double weight[8];
    Matrix3 backward;
  };

  /// Calls visit(voxel, place, dependence) for the voxels that tetrahedron t owns, in their order.
  template <class Visit>
  void for_tet(std::int64_t t, const Visit& visit) const {
    const TetSetup& tet = setups_[static_cast<std::size_t>(t)];
    HexCache cache;
    int x[3];
    for (x[2] = tet.begin[2]; x[2] < tet.end[2]; ++x[2]) {
      for (x[1] = tet.begin[1]; x[1] < tet.end[1]; ++x[1]) {
        for (x[0] = tet.begin[0]; x[0] < tet.end[0]; ++x[0]) {
          const std::int64_t voxel = geometry_.frame.offset_of(x[0], x[1], x[2]);
          if (owners_[static_cast<std::size_t>(voxel)] != t) continue;
          SourcePlace place;
          Dependence dependence;
          set_place(t, x, cache, place);
          if (set_dependence(t, x, cache, dependence)) visit(voxel, place, dependence);
        }
      }
    }
  }
  /// The nodes that Dependence::weight belongs to.
  std::span<const std::int32_t> nodes_of(std::int64_t t) const {
    if (hexes_.has(t)) return {hexes_.nodes_of(t), 8};
    return mesh_.tets[static_cast<std::size_t>(t)];
  }

 private:
  static constexpr std::int32_t uncovered = -1, left_out = -2;

  /// The map of the hexahedron that was needed last.
  struct HexCache {
    std::int64_t tet = -1;
    std::optional<HexMap> map;
  };

  void find_owners(const std::vector<Point3>& deformed, int threads);
  void set_up(const std::vector<Point3>& deformed, int threads);
  const HexMap& hex_map(std::int64_t t, HexCache& cache) const;
  void set_place(std::int64_t t, const int* x, HexCache& cache, SourcePlace& place) const;
  /// @returns false where the map of a hexahedron is singular
  bool set_dependence(std::int64_t t, const int* x, HexCache& cache, Dependence& result) const;
  static void split(const double* position, SourcePlace& place);

  Grid source_, output_;
  Mesh mesh_;  ///< its last tetrahedra are those that the hexahedra were split into
  WarpGeometry geometry_;
  HexView hexes_;
  std::vector<Node> nodes_;  ///< deformed
  std::vector<TetSetup> setups_;
  std::vector<std::int32_t> owners_;  ///< tetrahedron per voxel of the output, or one of the above
};

}  // namespace tetwarp
