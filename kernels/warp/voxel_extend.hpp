/// @file voxel_extend.hpp
/// Stage "extend" of the warp, after the raster: voxels that no tetrahedron covers move with the
/// nearest point of the mesh.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/surface_near.hpp"
#include "kernels/warp/surface_tree.hpp"

namespace tetwarp {

/// How displacements go on outside of the mesh.
struct Extension {
  SurfaceTree tree;
  double to_world[3][3];    ///< axes of the output [world per voxel]
  double from_world[3][3];  ///< a vector of the world in source voxels
  double reach;             ///< where displacements have fallen to zero [world]; infinite: nowhere

  /// From the output's first voxel to one of its voxels [world].
  TETWARP_HD void position(const double* index, double* x) const {
    for (int row = 0; row < 3; ++row) x[row] = dot_product(to_world[row], index);
  }

  /// Where the search for the nearest point of a position begins: within reach, with the triangle
  /// of the position before.
  TETWARP_HD void begin(const double* x, NearestSurfacePoint& nearest) const {
    const std::int64_t before = nearest.triangle;
    nearest.triangle = -1;
    nearest.distance2 = reach * reach;
    if (before >= 0) take_triangle(tree, before, x, nearest);
  }

  /// Displacement of a voxel: rest minus deformed position [world].
  /// @param nearest  the nearest point, if one is within reach
  TETWARP_HD void displacement(const NearestSurfacePoint& nearest, double* vector) const {
    double weight = nearest.triangle < 0 ? 0 : 1;
    if (weight > 0 && reach < INFINITY) {
      const double t = min_of(sqrt(nearest.distance2) / reach, 1.0);
      weight = 1 - t * t * (3 - 2 * t);
    }
    for (int axis = 0; axis < 3; ++axis) {
      vector[axis] = weight > 0 ? weight * nearest.to_rest[axis] : 0;
    }
  }
};

/// One index = a voxel; any order.
template <class T>
struct VoxelExtendOp {
  RasterJob<T> job;  ///< source, filter, background, volume, frame and the map `outside` are used
  View<const std::int32_t> owners;  ///< -1: to write
  Extension extension;
  float* displacement;  ///< [voxel][3]; null: not written

  TETWARP_HD void operator()(std::int64_t n) const {
    if (owners[n] >= 0) return;
    int voxel[3];
    job.frame.set_voxel(n, voxel);
    double index[3], x[3];
    set_index(voxel, index);
    extension.position(index, x);
    NearestSurfacePoint nearest = {0, -1, {0, 0, 0}};
    extension.begin(x, nearest);
    find_nearest(extension.tree, x, nearest);
    write(index, n, nearest);
  }

  /// Of a voxel of the frame in the output.
  TETWARP_HD void set_index(const int* voxel, double* index) const {
    for (int axis = 0; axis < 3; ++axis) index[axis] = job.outside.origin[axis] + voxel[axis];
  }

  /// @param nearest  of the voxel, if one is within reach
  TETWARP_HD void write(const double* index,
                        std::int64_t at,
                        const NearestSurfacePoint& nearest) const {
    double vector[3];
    extension.displacement(nearest, vector);
    int whole[3];
    ArithmeticOf<T> x[3];
    bool is_near = true;
    for (int row = 0; row < 3; ++row) {
      const double position = dot_product(job.outside.linear[row], index) +
                              job.outside.offset[row] +
                              dot_product(extension.from_world[row], vector);
      is_near = is_near && fabs(position) <= max_whole;  // not of NaN
      const double lower = is_near ? floor(position) : 0;
      whole[row] = static_cast<int>(lower) - job.source.origin[row];
      x[row] = static_cast<ArithmeticOf<T>>(is_near ? position - lower : 0);
    }
    if (displacement != nullptr) {
      for (int axis = 0; axis < 3; ++axis) {
        displacement[3 * at + axis] = static_cast<float>(vector[axis]);
      }
    }
    if (!is_near) {
      const int components = job.source.components;
      for (int c = 0; c < components; ++c) job.volume[at * components + c] = job.background;
      return;
    }
    const bool stays = vector[0] == 0 && vector[1] == 0 && vector[2] == 0;
    const bool copies = stays && job.copy_whole_shifts && job.outside.is_copy;
    store_position<true>(job, copies ? Filter::nearest : job.filter, whole, x, at);
  }
};

/// One index = a block of voxels; any order. For the host: triangles are searched once for a block,
/// see SurfaceNear.
template <class T>
struct BlockExtendOp {
  VoxelExtendOp<T> voxels;

  static constexpr int edge[3] = {SurfaceNear::lanes, 4, 4};  ///< of a block

  std::int64_t blocks_along(int axis) const {
    return (frame().end[axis] - frame().begin[axis] + edge[axis] - 1) / edge[axis];
  }
  std::int64_t index_count() const { return blocks_along(0) * blocks_along(1) * blocks_along(2); }

  void operator()(std::int64_t n) const {
    const std::int64_t along[3] = {n % blocks_along(0), n / blocks_along(0) % blocks_along(1),
                                   n / blocks_along(0) / blocks_along(1)};
    Block block;
    for (int axis = 0; axis < 3; ++axis) {
      block.begin[axis] = frame().begin[axis] + static_cast<int>(along[axis]) * edge[axis];
      block.end[axis] = min_of(block.begin[axis] + edge[axis], frame().end[axis]);
    }
    if (!is_covered(block)) extend(block);
  }

 private:
  struct Block {
    int begin[3], end[3];
  };

  const auto& frame() const { return voxels.job.frame; }

  bool is_covered(const Block& block) const {
    for (int k = block.begin[2]; k < block.end[2]; ++k) {
      for (int j = block.begin[1]; j < block.end[1]; ++j) {
        const std::int64_t first = frame().offset_of(block.begin[0], j, k);
        for (int i = 0; i < block.end[0] - block.begin[0]; ++i) {
          if (voxels.owners[first + i] < 0) return false;
        }
      }
    }
    return true;
  }

  void extend(const Block& block) const {
    const Extension& extension = voxels.extension;
    double middle[3], center[3], low[3], high[3], step[3], radius2 = 0;
    voxels.set_index(block.begin, low);
    voxels.set_index(block.end, high);
    for (int axis = 0; axis < 3; ++axis) middle[axis] = 0.5 * (low[axis] + high[axis] - 1);
    extension.position(middle, center);
    for (int corner = 0; corner < 4; ++corner) {  // and those opposite of them
      const double to_corner[3] = {middle[0] - low[0], (corner & 1 ? -1 : 1) * (middle[1] - low[1]),
                                   (corner & 2 ? -1 : 1) * (middle[2] - low[2])};
      double apart[3];
      extension.position(to_corner, apart);
      radius2 = max_of(radius2, dot_product(apart, apart));
    }
    const double along[3] = {1, 0, 0};
    extension.position(along, step);
    SurfaceNear near(extension.tree, center, sqrt(radius2), extension.reach);
    NearestSurfacePoint nearest = {0, -1, {0, 0, 0}};
    for (int k = block.begin[2]; k < block.end[2]; ++k) {
      for (int j = block.begin[1]; j < block.end[1]; ++j) {
        extend_row(block, j, k, step, near, nearest);
      }
    }
  }

  /// @param step  from one voxel of the row to the next [world]
  void extend_row(const Block& block,
                  int j,
                  int k,
                  const double* step,
                  SurfaceNear& near,
                  NearestSurfacePoint& nearest) const {
    const Extension& extension = voxels.extension;
    const auto place = [&](int i, double* index, double* x) {
      const int voxel[3] = {i, j, k};
      voxels.set_index(voxel, index);
      extension.position(index, x);
    };
    double index[3], x[3];
    std::int64_t at = frame().offset_of(block.begin[0], j, k);
    bool is_row_begun = near.is_far();
    for (int lane = 0; lane < block.end[0] - block.begin[0]; ++lane, ++at) {
      if (voxels.owners[at] >= 0) continue;
      if (!is_row_begun) {
        place(block.begin[0], index, x);
        near.begin_row(x, step);
        is_row_begun = true;
      }
      place(block.begin[0] + lane, index, x);
      extension.begin(x, nearest);
      if (!near.is_far()) near.find(lane, x, nearest);
      voxels.write(index, at, nearest);
    }
  }
};

/// Writes the voxels that no tetrahedron covers.
///
/// @param exec  where to run
/// @param body  input and output
///
/// Determinism: the nearest point is found in float64, by distance and then by number, so that any
/// region has the bits of the whole grid. Back ends differ by rounding, and may choose another one
/// of two points whose distances are equal within it. Cost: about 10 boxes and 13 triangles a
/// voxel; on the host 2 or 3 triangles, and the distances to 10 to 40 that the voxels of a block
/// share. Source: ours.
template <class Exec, class T>
void voxel_extend(Exec& exec, const VoxelExtendOp<T>& body) {
  if constexpr (Exec::reads_are_free) {
    const BlockExtendOp<T> blocks{body};
    exec.for_each("warp/fields", blocks.index_count(), blocks);
  } else {
    exec.for_each("warp/fields", body.job.frame.voxel_count(), body);
  }
}

}  // namespace tetwarp
