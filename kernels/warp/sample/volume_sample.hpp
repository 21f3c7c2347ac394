/// @file volume_sample.hpp
/// Samples the source at a position of its index space, by the nearest voxel or linearly. Wider
/// filters: volume_filter.hpp; labels: volume_label.hpp.
///
/// A position is an integer voxel `whole` plus a small local part, so that float32 is as accurate
/// in large volumes as in small ones. The source is defined on [-0.5, N - 0.5] per axis; indices of
/// neighbors are clamped to the source.
#pragma once
#include <cstdint>
#include <limits>
#include <tetwarp/choices.hpp>
#include <type_traits>

#include "kernels/base/hd.hpp"
#include "kernels/base/mul_add.hpp"
#include "kernels/base/pixel.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// Whether a filter is sampled by volume_filter.hpp or volume_label.hpp, not by tap_of() and
/// sample(): all but nearest and linear, also filters of only 2x2x2 samples.
TETWARP_HD bool is_wide(Filter filter) {
  return filter > Filter::linear;
}

/// Most samples that a filter reads on either side of a position; near the border of the source
/// mirrored ones may be one further inside.
TETWARP_HD int reach_of(Filter filter) {
  if (filter == Filter::cubic) return 2;
  return filter == Filter::bspline || filter == Filter::lanczos ? 3 : 1;
}

/// Largest distance by which rounding of nodes and of float32 positions may move a position from
/// the source's border to its outside [voxel]. Such positions count as inside.
constexpr float rim_slack = 0x1p-19f;

/// The source's samples [k][j][i][component], and data that some filters need with them.
///
/// May be a window of the source. Then no position is sampled beyond an end of the window unless
/// the source ends there too; positions are relative to its first voxel, a whole-voxel shift
/// without rounding.
template <class T>
struct SourceView {
  const T* data;
  int dims[3];
  int components;
  /// Coefficients of the spline through the samples, in their order; null unless the filter is
  /// bspline.
  const ArithmeticOf<T>* coefficients = nullptr;
  /// Smallest and largest sample per component, to which values are clamped; null: no clamping.
  const ArithmeticOf<T>* range = nullptr;
  int origin[3] = {0, 0, 0};  ///< index in the source of the first voxel of the samples
};

/// Map from voxels of a cell to source positions: whole + (base + axis[0] i + axis[1] j + axis[2]
/// k).
template <class Real>
struct SourceMap {
  Real base[3];
  Real axis[3][3];  ///< axis[a][row]: source step along `row` per output step along `a`
  int whole[3];
};

constexpr double max_whole = 0x1p30;  ///< larger indices are clamped to it; no source is as large

/// The voxel from which local positions count, for a position along one axis of the source.
TETWARP_HD double whole_voxel(double start) {
  return floor(min_of(max_of(start, -max_whole), max_whole));
}

/// The map from (i, j, k) to start + linear (i, j, k), split into whole voxels and a local part.
template <class Real>
TETWARP_HD SourceMap<Real> make_source_map(const double* start, const double (*linear)[3]) {
  SourceMap<Real> map;
  for (int row = 0; row < 3; ++row) {
    const double whole = whole_voxel(start[row]);
    map.whole[row] = static_cast<int>(whole);
    map.base[row] = static_cast<Real>(start[row] - whole);
    for (int a = 0; a < 3; ++a) map.axis[a][row] = static_cast<Real>(linear[row][a]);
  }
  return map;
}

/// The same, with positions relative to the first voxel of the view's window.
template <class Real, class T>
TETWARP_HD SourceMap<Real> make_source_map(const SourceView<T>& source,
                                           const double* start,
                                           const double (*linear)[3]) {
  SourceMap<Real> map = make_source_map<Real>(start, linear);
  for (int row = 0; row < 3; ++row) map.whole[row] -= source.origin[row];
  return map;
}

/// Local position x of voxel (i, j, k), whole numbers of any type. Other code repeats this order of
/// operations to get equal bits.
/// @param map  a SourceMap, or another type with its `base` and `axis`
template <class Map, class Real, class Index>
TETWARP_HD void local_position(const Map& map, Index i, Index j, Index k, Real* x) {
  for (int row = 0; row < 3; ++row) {
    const Real line =
        mul_add(map.axis[2][row], Real(k), mul_add(map.axis[1][row], Real(j), map.base[row]));
    x[row] = mul_add(map.axis[0][row], Real(i), line);
  }
}

/// Neighbors and weights of one position for nearest and linear.
template <class Real>
struct Tap {
  bool inside;                ///< the source is defined there; else the voxel is background
  std::int64_t offset[3][2];  ///< of the lower and upper neighbor per axis [sample]
  Real fraction[3];
};

/// Whether coordinate whole + x lies within the source along an axis.
template <class T, class Real>
TETWARP_HD bool is_defined(const SourceView<T>& source, int axis, int whole, Real x) {
  // Bounds are shifted to the local part, where the comparison is exact for any `whole`.
  const Real low = Real(-0.5) - Real(whole) - Real(rim_slack);
  const Real high = Real(source.dims[axis] - 1 - whole) + Real(0.5) + Real(rim_slack);
  return x >= low && x <= high;
}

/// Neighbors and weights for filters nearest and linear at position whole + x.
template <class T, class Real>
TETWARP_HD Tap<Real> tap_of(const SourceView<T>& source,
                            Filter filter,
                            const int* whole,
                            const Real* x) {
  Tap<Real> tap;
  tap.inside = true;
  std::int64_t stride = source.components;
  for (int axis = 0; axis < 3; ++axis) {
    const int last = source.dims[axis] - 1;
    tap.inside = tap.inside && is_defined(source, axis, whole[axis], x[axis]);
    const Real near = filter == Filter::nearest ? x[axis] + Real(0.5) : x[axis];
    const Real lower = tap.inside ? floor(near) : Real(0);
    const int voxel = whole[axis] + static_cast<int>(lower);
    // Beyond the outermost voxel centers there is only one neighbor.
    const bool blends = filter == Filter::linear && voxel >= 0 && voxel < last;
    tap.fraction[axis] = blends ? near - lower : Real(0);
    tap.offset[axis][0] = min_of(max_of(voxel, 0), last) * stride;
    tap.offset[axis][1] = min_of(max_of(voxel + 1, 0), last) * stride;
    stride *= source.dims[axis];
  }
  return tap;
}

/// a + f (b - a); a if f is zero, so that a NaN in b does not spread.
template <class Real>
TETWARP_HD Real lerp_of(Real f, Real a, Real b) {
  return f > Real(0) ? mul_add(f, b - a, a) : a;
}

/// Linear interpolation of one component, not rounded.
/// @param s  the component at voxel 0
template <class T, class Real>
TETWARP_HD Real linear_value(const T* s, const Tap<Real>& tap) {
  Real column[2];  // interpolated along y, then z; along x last
  for (int x = 0; x < 2; ++x) {
    const T* at = s + tap.offset[0][x];
    Real slice[2];
    for (int z = 0; z < 2; ++z) {
      slice[z] =
          lerp_of(tap.fraction[1], static_cast<Real>(at[tap.offset[2][z] + tap.offset[1][0]]),
                  static_cast<Real>(at[tap.offset[2][z] + tap.offset[1][1]]));
    }
    column[x] = lerp_of(tap.fraction[2], slice[0], slice[1]);
  }
  return lerp_of(tap.fraction[0], column[0], column[1]);
}

/// One component of the source at a tap. @pre tap.inside
template <class T, class Real>
TETWARP_HD T
sample(const SourceView<T>& source, Filter filter, const Tap<Real>& tap, int component) {
  const T* s = source.data + component;
  if (filter == Filter::nearest) {
    return s[tap.offset[0][0] + tap.offset[1][0] + tap.offset[2][0]];
  }
  return rounded_to<T>(linear_value(s, tap));
}

}  // namespace tetwarp
