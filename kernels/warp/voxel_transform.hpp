/// @file voxel_transform.hpp
/// Stage "raster" of the warp for averaged, reoriented or scaled samples: float64, rounded once.
#pragma once
#include <cstdint>

#include "kernels/base/symmetric_eigen.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/sample/volume_filter.hpp"
#include "kernels/warp/sample/volume_sample.hpp"
#include "kernels/warp/tet_transform.hpp"

namespace tetwarp {

constexpr int max_transform_components = 9;

/// filter_taps() for any pixel type, out of line. It reads only the dimensions of the source.
TETWARP_HD_RARE void set_transform_taps(const SourceView<double>& shape,
                                        Filter filter,
                                        const SourcePosition<double>& at,
                                        FilterTaps<double>& taps) {
  taps = filter_taps(shape, filter, at);
}

/// blended() in plain loops: slower, but little code.
template <class Sample>
TETWARP_HD double looped_blend(const FilterTaps<double>& taps, const Sample* samples) {
  const double near = static_cast<double>(samples[taps.near]);
  double sum = 0;
  for (int z = 0; z < taps.count; ++z) {
    double slice = 0;
    for (int y = 0; y < taps.count; ++y) {
      const Sample* line = samples + (taps.offset[2][z] + taps.offset[1][y]);
      double row = 0;
      for (int x = 0; x < taps.count; ++x) {
        row += taps.weight[0][x] * (static_cast<double>(line[taps.offset[0][x]]) - near);
      }
      slice += taps.weight[1][y] * row;
    }
    sum += taps.weight[2][z] * slice;
  }
  return near + sum;
}

/// Adds the source at whole + x to `sums`, one per component, not rounded.
/// @returns false where the source is not defined
template <class T>
TETWARP_HD bool add_values(
    const SourceView<T>& source, Filter filter, const int* whole, const double* x, double* sums) {
  const bool is_nearest = filter == Filter::nearest;
  if (!is_wide(filter)) {
    const Tap<double> tap = tap_of(source, filter, whole, x);
    for (int c = 0; c < source.components && tap.inside; ++c) {
      sums[c] += is_nearest ? static_cast<double>(sample(source, filter, tap, c))
                            : linear_value(source.data + c, tap);
    }
    return tap.inside;
  }
  SourcePosition<double> at;
  for (int axis = 0; axis < 3; ++axis) {
    if (!is_defined(source, axis, whole[axis], x[axis])) return false;
    at.voxel[axis] = whole[axis] + static_cast<int>(floor(x[axis]));
    at.fraction[axis] = x[axis] - floor(x[axis]);
  }
  FilterTaps<double> taps;
  SourceView<double> shape = {
      nullptr, {source.dims[0], source.dims[1], source.dims[2]}, source.components};
  set_transform_taps(shape, filter, at, taps);
  const bool is_center = at.fraction[0] == 0 && at.fraction[1] == 0 && at.fraction[2] == 0;
  for (int c = 0; c < source.components; ++c) {
    sums[c] += is_center                   ? static_cast<double>(source.data[taps.near + c])
               : filter == Filter::bspline ? looped_blend(taps, source.coefficients + c)
                                           : looped_blend(taps, source.data + c);
  }
  return true;
}

/// Replaces v by m v.
TETWARP_HD void transform_vector(const Matrix3& m, double* v) {
  const double x = v[0], y = v[1], z = v[2];
  for (int row = 0; row < 3; ++row) v[row] = m.at[row][0] * x + m.at[row][1] * y + m.at[row][2] * z;
}

/// A symmetric tensor of components XX YY ZZ XY YZ XZ as a matrix, and back.
TETWARP_HD Matrix3 tensor_of(const double* d) {
  return {{{d[0], d[3], d[5]}, {d[3], d[1], d[4]}, {d[5], d[4], d[2]}}};
}
TETWARP_HD void set_tensor(const Matrix3& tensor, double* d) {
  for (int axis = 0; axis < 3; ++axis) d[axis] = tensor.at[axis][axis];
  d[3] = tensor.at[0][1];
  d[4] = tensor.at[1][2];
  d[5] = tensor.at[0][2];
}

/// Makes v a unit vector. @returns false if it is zero
TETWARP_HD bool normalize(double* v) {
  const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int axis = 0; axis < 3; ++axis) v[axis] /= length;
  return length > 0;
}

/// Reorients a tensor by preservation of the principal direction: eigenvalues do not change, the
/// first eigenvector e1 becomes F e1, the second lies in the plane of F e1 and F e2, whose normal
/// is along F^-T e3; all normalized.
/// @param backward  the inverse of F
/// Source: D. C. Alexander et al., "Spatial transformations of diffusion tensor magnetic resonance
/// images", 2001.
TETWARP_HD_RARE void preserve_principal(const Matrix3& backward, double* d) {
  Matrix3 values = tensor_of(d), vectors;
  symmetric_eigen<3>(values.at, vectors.at);
  int order[3] = {0, 1, 2};  // eigenvalues descend
  for (int pass = 0; pass < 3; ++pass) {
    const int a = pass % 2, b = a + 1;
    if (values.at[order[a]][order[a]] >= values.at[order[b]][order[b]]) continue;
    const int first = order[a];
    order[a] = order[b];
    order[b] = first;
  }
  double frame[3][3];  // unit vectors, of descending eigenvalues
  for (int row = 0; row < 3; ++row) {
    frame[0][row] = vectors.at[row][order[0]];
    frame[2][row] = vectors.at[row][order[2]];
  }
  transform_vector(forward_direction(backward), frame[0]);
  transform_vector(transposed(backward), frame[2]);
  if (!normalize(frame[0]) || !normalize(frame[2])) return;
  for (int row = 0; row < 3; ++row) {
    const int r1 = (row + 1) % 3, r2 = (row + 2) % 3;
    frame[1][row] = frame[2][r1] * frame[0][r2] - frame[2][r2] * frame[0][r1];
  }
  Matrix3 turned = {};
  for (int e = 0; e < 3; ++e) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        turned.at[row][column] += values.at[order[e]][order[e]] * frame[e][row] * frame[e][column];
      }
    }
  }
  set_tensor(turned, d);
}

/// Reorients the components of one sample in place.
/// @param matrix  from matrix_of()
TETWARP_HD void reorient(Quantity reorientation, const Matrix3& matrix, double* values) {
  switch (reorientation) {
    case Quantity::components:
      return;
    case Quantity::vector:
    case Quantity::covariant_vector:
    case Quantity::contravariant_vector:
      return transform_vector(matrix, values);
    case Quantity::tensor:
      return set_tensor(matrix * tensor_of(values) * transposed(matrix), values);
    case Quantity::principal_tensor:
      return preserve_principal(matrix, values);
  }
}

/// The members of a job that store_transformed() reads.
template <class T>
struct TransformSampler {
  SourceView<T> source;
  Filter filter;
  Quantity reorientation;
  T background;

  explicit TETWARP_HD TransformSampler(const RasterJob<T>& job)
      : source(job.source),
        filter(job.filter),
        reorientation(job.reorientation),
        background(job.background) {}
};

/// Stores the transformed samples of a voxel at source position map.whole + x. Parts of the voxel
/// outside the source are ignored; if all are outside, the voxel is background.
/// @param map  gives the size of the voxel in the source
/// @param out  shape [components]
template <class T>
TETWARP_HD_RARE void store_transformed(TransformSampler<T> job,
                                       const VoxelTransform& transform,
                                       const SourceMap<double>& map,
                                       const double* x,
                                       T* out) {
  if constexpr (can_blend<T>) {
    const int components = job.source.components;
    double values[max_transform_components] = {}, offset[3];
    int part[3], count = 0;
    for (part[2] = 0; part[2] < transform.parts[2]; ++part[2]) {
      for (part[1] = 0; part[1] < transform.parts[1]; ++part[1]) {
        for (part[0] = 0; part[0] < transform.parts[0]; ++part[0]) {
          for (int a = 0; a < 3; ++a) offset[a] = (part[a] + 0.5) / transform.parts[a] - 0.5;
          double at[3];
          for (int row = 0; row < 3; ++row) {
            at[row] = x[row] + (map.axis[0][row] * offset[0] + map.axis[1][row] * offset[1] +
                                map.axis[2][row] * offset[2]);
          }
          count += add_values(job.source, job.filter, map.whole, at, values);
        }
      }
    }
    for (int c = 0; c < components; ++c) {
      values[c] /= max_of(count, 1);
      if (job.source.range == nullptr) continue;
      const double low = job.source.range[2 * c], high = job.source.range[2 * c + 1];
      values[c] = values[c] < low ? low : values[c] > high ? high : values[c];
    }
    if (!transform.is_plain) reorient(job.reorientation, transform.matrix, values);
    for (int c = 0; c < components; ++c) {
      out[c] = count > 0 ? rounded_to<T>(values[c] * transform.scale) : job.background;
    }
  }
}

/// Stores a voxel that tetrahedron t owns, by the transform of t.
template <class T>
TETWARP_HD_RARE void store_transformed_voxel(const RasterJob<T>& job,
                                             std::int64_t t,
                                             const CellVoxel& voxel) {
  double start[3], linear[3][3], x[3];
  map_start(job.setups[t], voxel.corner, start, linear);
  auto map = make_source_map<double>(job.source, start, linear);
  local_position(map, voxel.i, voxel.j, voxel.k, x);
  if (job.setups[t].kind == MapKind::trilinear) {
    const int frame_voxel[3] = {voxel.corner[0] + voxel.i, voxel.corner[1] + voxel.j,
                                voxel.corner[2] + voxel.k};
    hex_source_position(hex_map_of(job, t), frame_voxel, map.whole, x);
    for (int row = 0; row < 3; ++row) map.whole[row] -= job.source.origin[row];
  }
  T* const out = job.volume + voxel.offset * job.source.components;
  store_transformed(TransformSampler<T>(job), job.transforms[t], map, x, out);
}

/// Stores a voxel that no tetrahedron covers, by job.outside_transform.
template <class T>
TETWARP_HD void store_transformed_outside(const RasterJob<T>& job, const CellVoxel& voxel) {
  double start[3], x[3];
  outside_start(job.outside, voxel.corner, start);
  const auto map = make_source_map<double>(job.source, start, job.outside.linear);
  local_position(map, voxel.i, voxel.j, voxel.k, x);
  T* const out = job.volume + voxel.offset * job.source.components;
  store_transformed(TransformSampler<T>(job), job.outside_transform, map, x, out);
}

}  // namespace tetwarp
