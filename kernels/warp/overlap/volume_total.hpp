/// @file volume_total.hpp
/// Sum of all samples of a volume, and integral of a source over a mesh.
#pragma once
#include <cstdint>

#include "kernels/base/any_number.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/overlap/convex_part.hpp"
#include "kernels/warp/tet_widen.hpp"

namespace tetwarp {

/// One index = one component of part_voxels consecutive voxels; any order.
struct VolumeSumOp {
  static constexpr int resident_blocks = 4;  ///< leaves 64 registers per thread: no spills
  static constexpr std::int64_t part_voxels = 4096;
  NumberView volume;
  std::int64_t voxel_count;
  int components;
  View<double> sums;  ///< [part][component]

  TETWARP_HD void operator()(std::int64_t index) const {
    const std::int64_t part = index / components, c = index % components;
    const std::int64_t end = min_of((part + 1) * part_voxels, voxel_count);
    double sum = 0;
    for (std::int64_t v = part * part_voxels; v < end; ++v) sum += volume.at(v * components + c);
    sums[index] = sum;
  }
};

/// Number of partial sums per component of a volume.
TETWARP_HD std::int64_t volume_part_count(std::int64_t voxel_count) {
  return (voxel_count + VolumeSumOp::part_voxels - 1) / VolumeSumOp::part_voxels;
}

/// Sums all samples of each component by a tree that depends only on the number of voxels.
///
/// @param exec         where to run
/// @param volume       samples, shape [voxel_count][components]
/// @param voxel_count  number of voxels
/// @param components   per voxel
/// @param scratch      shape [2 * volume_part_count(voxel_count) * components]
/// @param totals       out, shape [components]
///
/// Determinism: same bits on every back end. Cost: one read of the volume.
/// Source: ours.
template <class Exec>
void volume_total(Exec& exec,
                  NumberView volume,
                  std::int64_t voxel_count,
                  int components,
                  View<double> scratch,
                  View<double> totals) {
  double* to = scratch.data;
  double* other = scratch.data + scratch.size / 2;
  for (bool is_done = false; !is_done;) {
    const std::int64_t parts = volume_part_count(voxel_count);
    is_done = parts == 1;
    const View<double> sums = {is_done ? totals.data : to, parts * components};
    exec.for_each("warp/raster", sums.size, VolumeSumOp{volume, voxel_count, components, sums});
    volume = {sums.data, PixelType::float64};
    voxel_count = parts;
    double* const last = to;
    to = other;
    other = last;
  }
}

/// Planes and box of a tetrahedron at rest in the grid of the source; an empty box if it is flat.
TETWARP_HD TetSetup rest_setup(const TetNodes& tet, const OutputFrame& frame) {
  TetSetup setup = {};
  Barycentric of_nodes[4];
  set_box(tet, frame, setup);
  if (set_planes<Int128>(tet, setup, of_nodes) == 0) return {};
  widen_box(tet, frame, setup);
  return setup;
}

/// One index = one tetrahedron; any order. Counts the slices of the source that its box intersects:
/// the items of TetSliceMassOp.
struct TetSliceCountOp {
  View<const std::int32_t> tets;
  View<const Node> rest;
  OutputFrame frame;  ///< the source
  View<std::int64_t> counts;

  TETWARP_HD void operator()(std::int64_t t) const {
    const TetSetup setup = rest_setup(tet_nodes(rest, tets.data + 4 * t), frame);
    counts[t] = is_empty(setup) ? 0 : setup.end[2] - setup.begin[2];
  }
};

/// One item = one slice of the source in the box of one tetrahedron; any order. Sums sample times
/// volume of the voxel within the tetrahedron, per component.
struct TetSliceMassOp {
  View<const std::int32_t> tets;
  View<const Node> rest;
  OutputFrame frame;
  NumberView source;
  int components;
  View<double> sums;  ///< [item][component]

  TETWARP_HD void operator()(std::int64_t t, std::int64_t slice, std::int64_t item) const {
    const TetSetup setup = rest_setup(tet_nodes(rest, tets.data + 4 * t), frame);
    const int k = setup.begin[2] + static_cast<int>(slice);
    for (int c = 0; c < components; ++c) sums[item * components + c] = 0;
    ConvexPart part, other;
    for (int j = setup.begin[1]; j < setup.end[1]; ++j) {
      for (int i = setup.begin[0]; i < setup.end[0]; ++i) {
        const int x[3] = {i, j, k};
        double height[4];
        const BoxPlace place = place_of_box(setup, x, height);
        if (place == BoxPlace::outside) continue;
        const bool is_whole = place == BoxPlace::inside;
        const ConvexPart* const held = is_whole ? nullptr : part_in_tet(setup, height, part, other);
        if (!is_whole && held == nullptr) continue;
        const double share = is_whole ? 1 : volume_of(*held);
        const std::int64_t at = frame.offset_of(i, j, k) * components;
        for (int c = 0; c < components && share > 0; ++c) {
          sums[item * components + c] += share * source.at(at + c);
        }
      }
    }
  }
};

}  // namespace tetwarp
