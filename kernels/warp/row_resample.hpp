/// @file row_resample.hpp
/// Stage "resample": samples of the source where transforms take the voxels of a row.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/sample/transform_link.hpp"

namespace tetwarp {

/// From output voxels to positions in the source's index space: an affine map, to which the
/// displacement of a field on the output's grid may be added; or transforms that follow each other.
/// Affine maps around a single field or spline are part of these maps.
struct ResampleMap {
  IndexAffine to_source;            ///< output index to source index, without displacements
  FieldView field;                  ///< on the output's grid
  double from_world[3][3];          ///< a displacement in source voxels
  View<const TransformLink> links;  ///< size 0: none; the first one is a field or a spline
  IndexAffine to_world;             ///< output index to the place from which `links` displace
  IndexAffine to_first;             ///< output index to where the first link is applied [world]
  IndexAffine to_first_index;       ///< the same in the index space of its grid
  bool is_parallel;    ///< the only link is a field with a grid along the axes of the output's
  bool only_in_field;  ///< positions beyond a field or spline are beyond the source

  TETWARP_HD bool has_field() const { return field.vectors != nullptr; }

  /// @returns false for background
  TETWARP_HD bool position(std::int64_t i, std::int64_t j, std::int64_t k, double* x) const {
    const double voxel[3] = {static_cast<double>(i), static_cast<double>(j),
                             static_cast<double>(k)};
    to_source.map(voxel, x);
    double vector[3];
    if (links.size > 0) {
      if (!set_vector(voxel, vector)) return false;
    } else if (has_field()) {
      const float* const v = field.at(i, j, k);
      for (int axis = 0; axis < 3; ++axis) vector[axis] = static_cast<double>(v[axis]);
    } else {
      return true;
    }
    for (int row = 0; row < 3; ++row) {
      const double* const m = from_world[row];
      x[row] += m[0] * vector[0] + m[1] * vector[1] + m[2] * vector[2];
    }
    return true;
  }

 private:
  /// The displacement by `links`. @returns false for background
  TETWARP_HD bool set_vector(const double* voxel, double* vector) const {
    double start[3], x[3], index[3];
    to_world.map(voxel, start);
    to_first.map(voxel, x);
    to_first_index.map(voxel, index);
    bool is_inside = links[0].move_at(index, x);
    for (std::int64_t n = 1; n < links.size; ++n) is_inside = links[n].move(x) && is_inside;
    for (int axis = 0; axis < 3; ++axis) vector[axis] = x[axis] - start[axis];
    return is_inside || !only_in_field;
  }
};

/// One index = one row of the output; any order. resample() calls it on host threads, in vectors
/// where it can: host/warp/cpu/rows/row_resample_cpu.hpp.
///
/// Determinism: positions in float64, samples as in cell_raster.hpp; the same bits for any number
/// of threads. Cost: 12 bytes of field and about 40 operations per voxel beside its sample.
/// Source: ours.
template <class T>
struct RowResampleOp {
  RasterJob<T> job;  ///< source, filter, background and volume are used
  ResampleMap map;
  std::int64_t dims[3];            ///< of the output, or of a part of it of whole rows
  std::int64_t begin[2] = {0, 0};  ///< first row and slice of the part in the output
  bool may_use_vectors = true;

  /// @param voxel  number of (i, j, k) in the part
  TETWARP_HD void store(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t voxel) const {
    double position[3];
    int whole[3];
    ArithmeticOf<T> x[3];
    bool is_near = map.position(i, j, k, position);
    for (int axis = 0; axis < 3; ++axis) {
      is_near = is_near && fabs(position[axis]) <= max_whole;  // not of NaN
      const double lower = is_near ? floor(position[axis]) : -1;
      whole[axis] = static_cast<int>(lower) - job.source.origin[axis];
      x[axis] = static_cast<ArithmeticOf<T>>(position[axis] - lower);
    }
    if (is_near) return store_position<true>(job, job.filter, whole, x, voxel);
    const int components = job.source.components;
    for (int c = 0; c < components; ++c) job.volume[voxel * components + c] = job.background;
  }

  TETWARP_HD void operator()(std::int64_t row) const {
    const std::int64_t j = begin[0] + row % dims[1], k = begin[1] + row / dims[1];
    for (std::int64_t i = 0; i < dims[0]; ++i) store(i, j, k, row * dims[0] + i);
  }
};

}  // namespace tetwarp
