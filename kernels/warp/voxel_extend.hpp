/// @file voxel_extend.hpp
/// Stage "extend" of the warp, after the raster: voxels that no tetrahedron covers move with the
/// nearest point of the mesh.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/surface_tree.hpp"

namespace tetwarp {

/// How displacements go on outside of the mesh.
struct Extension {
  SurfaceTree tree;
  double to_world[3][3];    ///< axes of the output [world per voxel]
  double from_world[3][3];  ///< a vector of the world in source voxels
  double reach;             ///< where displacements have fallen to zero [world]; infinite: nowhere

  /// Displacement of a voxel: rest minus deformed position [world].
  /// @param index    voxel of the output grid
  /// @param nearest  in: where to begin; out: the nearest point, if one is within reach
  TETWARP_HD void displacement(const double* index,
                               NearestSurfacePoint& nearest,
                               double* vector) const {
    double x[3];
    for (int row = 0; row < 3; ++row) x[row] = dot_product(to_world[row], index);
    const std::int64_t before = nearest.triangle;
    nearest.triangle = -1;
    nearest.distance2 = reach * reach;
    if (before >= 0) take_triangle(tree, before, x, nearest);
    find_nearest(tree, x, nearest);
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

/// One index = a stretch of voxels of a row; any order.
template <class T>
struct VoxelExtendOp {
  RasterJob<T> job;  ///< source, filter, background, volume, frame and the map `outside` are used
  View<const std::int32_t> owners;  ///< -1: to write
  Extension extension;
  float* displacement;  ///< [voxel][3]; null: not written
  int stretch;          ///< voxels per index

  TETWARP_HD std::int64_t stretches_per_row() const {
    return (job.frame.end[0] - job.frame.begin[0] + stretch - 1) / stretch;
  }
  TETWARP_HD std::int64_t index_count() const {
    return stretches_per_row() * (job.frame.end[1] - job.frame.begin[1]) *
           (job.frame.end[2] - job.frame.begin[2]);
  }

  TETWARP_HD void operator()(std::int64_t n) const {
    int voxel[3];
    job.frame.set_row_start(n / stretches_per_row(), voxel);
    voxel[0] += static_cast<int>(n % stretches_per_row()) * stretch;
    const int past = min_of(voxel[0] + stretch, job.frame.end[0]);
    NearestSurfacePoint nearest = {0, -1, {0, 0, 0}};
    for (; voxel[0] < past; ++voxel[0]) {
      const std::int64_t at = job.frame.offset_of(voxel[0], voxel[1], voxel[2]);
      if (owners[at] < 0) write(voxel, at, nearest);
    }
  }

  TETWARP_HD void write(const int* voxel, std::int64_t at, NearestSurfacePoint& nearest) const {
    double index[3], vector[3];
    for (int axis = 0; axis < 3; ++axis) index[axis] = job.outside.origin[axis] + voxel[axis];
    extension.displacement(index, nearest, vector);
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

/// Writes the voxels that no tetrahedron covers.
///
/// @param exec  where to run
/// @param body  input and output; `stretch` is set here: whole rows on the CPU, where a search
///              begins at the triangle of the voxel before, single voxels on a device
///
/// Determinism: the nearest point is found in float64, by distance and then by number, so that any
/// region has the bits of the whole grid. Back ends differ by rounding, and may choose another one
/// of two points whose distances are equal within it. Cost: about 10 boxes and 5 triangles a voxel.
/// Source: ours.
template <class Exec, class T>
void voxel_extend(Exec& exec, VoxelExtendOp<T> body) {
  body.stretch = Exec::reads_are_free ? body.job.frame.end[0] - body.job.frame.begin[0] : 1;
  exec.for_each("warp/fields", body.index_count(), body);
}

}  // namespace tetwarp
