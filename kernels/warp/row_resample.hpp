/// @file row_resample.hpp
/// Stage "resample": samples of the source where an affine map or a displacement field takes the
/// voxels of a row.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

/// An affine map between index spaces, or from the world to one.
struct IndexAffine {
  double linear[3][3];
  double offset[3];

  TETWARP_HD void map(const double* x, double* y) const {
    for (int row = 0; row < 3; ++row) {
      const double* const m = linear[row];
      y[row] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2] + offset[row];
    }
  }
};

/// Vectors on a grid.
struct FieldView {
  const float* vectors = nullptr;  ///< [k][j][i][3], world; null: there is no field
  std::int64_t dims[3] = {0, 0, 0};

  TETWARP_HD const float* at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return vectors + 3 * (i + dims[0] * (j + dims[1] * k));
  }

  /// The vector at an index position, linear between centers, constant for the last half voxel.
  /// @returns false beyond that; the vector is then zero
  TETWARP_HD bool sample(const double* index, double* vector) const {
    std::int64_t lower[3], upper[3];
    double fraction[3];
    for (int axis = 0; axis < 3; ++axis) {
      vector[axis] = 0;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double last = static_cast<double>(dims[axis] - 1);
      if (!(index[axis] >= -0.5 && index[axis] <= last + 0.5)) return false;
      const double near = min_of(max_of(index[axis], 0.0), last);
      lower[axis] = static_cast<std::int64_t>(near);
      upper[axis] = min_of(lower[axis] + 1, dims[axis] - 1);
      fraction[axis] = near - static_cast<double>(lower[axis]);
    }
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::int64_t place[3];
      for (int axis = 0; axis < 3; ++axis) {
        const bool is_upper = (corner >> axis & 1) != 0;
        weight *= is_upper ? fraction[axis] : 1 - fraction[axis];
        place[axis] = is_upper ? upper[axis] : lower[axis];
      }
      if (weight == 0) continue;  // so that a NaN there does not spread
      const float* const v = at(place[0], place[1], place[2]);
      for (int axis = 0; axis < 3; ++axis) vector[axis] += weight * static_cast<double>(v[axis]);
    }
    return true;
  }
};

/// From output voxels to positions in the source's index space.
struct ResampleMap {
  IndexAffine to_source;  ///< output index to source index, without the field
  FieldView field;
  bool is_field_grid;       ///< the field is on the output's grid
  IndexAffine to_field;     ///< output index to field index
  double from_world[3][3];  ///< a vector of the world in source voxels
  bool only_in_field;       ///< positions beyond the field are beyond the source

  /// The displacement of a voxel of a field that is there.
  /// @returns false for background
  TETWARP_HD bool field_vector(std::int64_t i,
                               std::int64_t j,
                               std::int64_t k,
                               double* vector) const {
    if (is_field_grid) {
      const float* const v = field.at(i, j, k);
      for (int axis = 0; axis < 3; ++axis) vector[axis] = static_cast<double>(v[axis]);
      return true;
    }
    const double voxel[3] = {static_cast<double>(i), static_cast<double>(j),
                             static_cast<double>(k)};
    double index[3];
    to_field.map(voxel, index);
    return field.sample(index, vector) || !only_in_field;
  }

  /// @returns false for background
  TETWARP_HD bool position(std::int64_t i, std::int64_t j, std::int64_t k, double* x) const {
    const double voxel[3] = {static_cast<double>(i), static_cast<double>(j),
                             static_cast<double>(k)};
    to_source.map(voxel, x);
    if (field.vectors == nullptr) return true;
    double vector[3];
    if (!field_vector(i, j, k, vector)) return false;
    for (int row = 0; row < 3; ++row) {
      const double* const m = from_world[row];
      x[row] += m[0] * vector[0] + m[1] * vector[1] + m[2] * vector[2];
    }
    return true;
  }
};

/// One index = one row of the output; any order. resample() calls it on host threads, in vectors
/// where it can: host/warp/cpu/row_resample_cpu.hpp.
///
/// Determinism: positions in float64, samples as in cell_raster.hpp; the same bits for any number
/// of threads. Cost: 12 bytes of field and about 40 operations per voxel beside its sample.
/// Source: ours.
template <class T>
struct RowResampleOp {
  RasterJob<T> job;  ///< source, filter, background and volume are used
  ResampleMap map;
  std::int64_t dims[3];  ///< of the output

  /// @param voxel  number of (i, j, k) in the output
  TETWARP_HD void store(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t voxel) const {
    double position[3];
    int whole[3];
    ArithmeticOf<T> x[3];
    bool is_near = map.position(i, j, k, position);
    for (int axis = 0; axis < 3; ++axis) {
      is_near = is_near && fabs(position[axis]) <= max_whole;  // not of NaN
      const double lower = is_near ? floor(position[axis]) : -1;
      whole[axis] = static_cast<int>(lower);
      x[axis] = static_cast<ArithmeticOf<T>>(position[axis] - lower);
    }
    if (is_near) return store_position<true>(job, job.filter, whole, x, voxel);
    const int components = job.source.components;
    for (int c = 0; c < components; ++c) job.volume[voxel * components + c] = job.background;
  }

  TETWARP_HD void operator()(std::int64_t row) const {
    const std::int64_t j = row % dims[1], k = row / dims[1];
    for (std::int64_t i = 0; i < dims[0]; ++i) store(i, j, k, row * dims[0] + i);
  }
};

}  // namespace tetwarp
