/// @file volume_filter.hpp
/// Filters wider than linear: cubic convolution, cubic B-spline, windowed sinc.
///
/// A value is computed as near + sum over taps of weight (sample - near), `near` being the sample
/// of largest weight. As weights sum to one this is the weighted sum, and a constant source gives
/// the constant bit for bit.
/// @see volume_prefilter.hpp for the coefficients that a spline has in place of samples
#pragma once
#include <cstdint>
#include <type_traits>

#include "kernels/base/hd.hpp"
#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {

constexpr int max_taps = 6;  ///< per axis

/// A position where the source is defined: the voxel below it, which may be index -1, and the
/// fraction of the way from there to the next voxel.
template <class Real>
struct SourcePosition {
  int voxel[3];
  Real fraction[3];  ///< 0 to 1
};

/// The samples that a filter reads around a position, as offsets and weights per axis.
template <class Real>
struct FilterTaps {
  int count;  ///< per axis: tap_count()
  std::int64_t offset[3][max_taps];
  Real weight[3][max_taps];
  std::int64_t near;   ///< offset of the sample of largest weight
  bool is_contiguous;  ///< taps along x follow each other in memory
};

/// Catmull-Rom: the cubic convolution of R. Keys (1981) with a = -1/2; reproduces quadratics.
/// @param t  fraction; Real may be a vector of numbers
/// @param w  out, weights of the samples at offsets -1, 0, 1, 2 from the voxel below
template <class Real>
TETWARP_HD void cubic_weights(Real t, Real* w) {
  w[0] = ((Real(-0.5) * t + Real(1.0)) * t - Real(0.5)) * t;
  w[1] = (Real(1.5) * t - Real(2.5)) * (t * t) + Real(1.0);
  w[2] = ((Real(-1.5) * t + Real(2.0)) * t + Real(0.5)) * t;
  w[3] = (Real(0.5) * t - Real(0.5)) * (t * t);
}

/// Cubic B-spline; on coefficients it reproduces cubic polynomials. Arguments as cubic_weights().
template <class Real>
TETWARP_HD void bspline_weights(Real t, Real* w) {
  const Real sixth = Real(1.0 / 6.0), u = Real(1.0) - t;
  w[0] = u * u * u * sixth;
  w[1] = ((Real(3.0) * t - Real(6.0)) * (t * t) + Real(4.0)) * sixth;
  w[2] = ((Real(3.0) * u - Real(6.0)) * (u * u) + Real(4.0)) * sixth;
  w[3] = t * t * t * sixth;
}

/// sin(pi x / 3) / x for x in [0, 1], to the rounding of Real.
template <class Real>
TETWARP_HD Real third_sine(Real x) {
  constexpr double third = 1.0471975511965977462;  // pi / 3
  constexpr int terms = std::is_same_v<Real, double> ? 9 : 5;
  const Real y = Real(third * third) * (x * x);
  Real series = Real(1.0);
  for (int n = terms; n > 0; --n) {
    series = Real(1.0) - y * series * Real(1.0 / (2 * n * (2 * n + 1)));
  }
  return Real(third) * series;
}

/// Lanczos-windowed sinc of three lobes: sinc(x) sinc(x / 3), normalized to sum one.
///
/// With s(x) = sin(pi x / 3), all six numerators follow from s(t) and s(1 - t), because s(1 + t) =
/// s(t) + s(1 - t) and s(x) = s(3 - x); sin(pi t), common to all, cancels. Multiplication by t (1 -
/// t) avoids divisions by zero.
/// @param w  out, weights of the samples at offsets -2 to 3 from the voxel below
template <class Real>
TETWARP_HD void lanczos_weights(Real t, Real* w) {
  const Real u = Real(1.0) - t, both = t * u;
  const Real at_t = third_sine(t), at_u = third_sine(u);
  const Real rising = at_t * t, falling = at_u * u;
  w[0] = both * falling / square_of(Real(2.0) + t);
  w[1] = Real(0.0) - both * (rising + falling) / square_of(Real(1.0) + t);
  w[2] = at_t * u;
  w[3] = at_u * t;
  w[4] = Real(0.0) - both * (rising + falling) / square_of(Real(1.0) + u);
  w[5] = both * rising / square_of(Real(2.0) + u);
  const Real scale = Real(1.0) / (((w[0] + w[5]) + (w[1] + w[4])) + (w[2] + w[3]));
  for (int i = 0; i < 6; ++i) w[i] = w[i] * scale;
}

/// Weights of a filter of this file; a filter without a branch gets those of lanczos. Real may be a
/// vector of numbers, which has no comparisons.
/// @param w  out, shape [tap_count()]
template <class Real>
TETWARP_HD void filter_weights(Filter filter, Real t, Real* w) {
  if (filter == Filter::cubic) {
    cubic_weights(t, w);
  } else if (filter == Filter::bspline) {
    bspline_weights(t, w);
  } else {
    lanczos_weights(t, w);
  }
}

TETWARP_HD int tap_count(Filter filter) {
  return filter == Filter::lanczos ? 6 : 4;
}

/// Index of the sample used at i when samples 0 to `last` are continued by mirroring at both ends.
TETWARP_HD int mirrored(int i, int last) {
  if (last == 0) return 0;
  const int within = (i < 0 ? -i : i) % (2 * last);
  return within > last ? 2 * last - within : within;
}

/// Taps of a filter of this file.
template <class T, class Real>
TETWARP_HD FilterTaps<Real> filter_taps(const SourceView<T>& source,
                                        Filter filter,
                                        const SourcePosition<Real>& at) {
  FilterTaps<Real> taps;
  taps.count = tap_count(filter);
  taps.near = 0;
  taps.is_contiguous = false;
  std::int64_t stride = source.components;
  for (int axis = 0; axis < 3; ++axis) {
    const Real t = at.fraction[axis];
    filter_weights(filter, t, taps.weight[axis]);
    const int last = source.dims[axis] - 1;
    const int first = at.voxel[axis] + 1 - taps.count / 2;
    const int nearest = taps.count / 2 - (t < Real(0.5) ? 1 : 0);
    bool is_plain = true;
    for (int i = 0; i < taps.count; ++i) {
      // A tap of zero weight reads the nearest sample, so that a NaN there does not spread.
      const int voxel = first + (taps.weight[axis][i] == Real(0) ? nearest : i);
      const int there =
          filter == Filter::bspline ? mirrored(voxel, last) : min_of(max_of(voxel, 0), last);
      is_plain = is_plain && there == first + i;
      taps.offset[axis][i] = there * stride;
    }
    if (axis == 0) taps.is_contiguous = is_plain && source.components == 1;
    taps.near += taps.offset[axis][nearest];
    stride *= source.dims[axis];
  }
  return taps;
}

/// near + sum of weight (sample - near) over width^3 samples, summed along y, then z, then x.
/// @tparam is_contiguous  whether taps along x are adjacent in memory
template <bool is_contiguous, int width, class Real, class Sample>
TETWARP_HD Real blended(const FilterTaps<Real>& taps, const Sample* samples) {
  const Real near = static_cast<Real>(samples[taps.near]);
  Real column[width] = {};
  for (int z = 0; z < width; ++z) {
    Real part[width] = {};
    for (int y = 0; y < width; ++y) {
      const Sample* line = samples + (taps.offset[2][z] + taps.offset[1][y]);
      if constexpr (is_contiguous) line += taps.offset[0][0];
      for (int x = 0; x < width; ++x) {
        const Sample sample = line[is_contiguous ? x : taps.offset[0][x]];
        part[x] += taps.weight[1][y] * (static_cast<Real>(sample) - near);
      }
    }
    for (int x = 0; x < width; ++x) column[x] += taps.weight[2][z] * part[x];
  }
  Real sum = 0;
  for (int x = 0; x < width; ++x) sum += taps.weight[0][x] * column[x];
  return near + sum;
}

/// blended() of one component, out of line.
template <int width, class Real, class Sample>
TETWARP_HD_RARE Real filtered(const FilterTaps<Real>& taps, const Sample* samples) {
  return taps.is_contiguous ? blended<true, width>(taps, samples)
                            : blended<false, width>(taps, samples);
}

/// A component's value as stored: clamped to source.range if there is one, rounded to T.
template <class T>
TETWARP_HD T finished(const SourceView<T>& source, ArithmeticOf<T> value, int component) {
  if (source.range != nullptr) {
    const ArithmeticOf<T>* const range = source.range + 2 * component;
    value = value < range[0] ? range[0] : value > range[1] ? range[1] : value;
  }
  return rounded_to<T>(value);
}

/// Value of component c at voxel `voxel`, around which the source is constant.
template <class T>
TETWARP_HD T constant_value(const SourceView<T>& source, std::int64_t voxel, int c) {
  const std::int64_t sample = voxel * source.components + c;
  if (source.coefficients == nullptr) return source.data[sample];
  return finished(source, source.coefficients[sample], c);
}

/// Samples the source by a filter of this file. At a voxel's center the result is that voxel's
/// sample, bit for bit. The last branch is bspline's: only that filter has coefficients.
/// @param out  shape [components]
template <class T>
TETWARP_HD void sample_filtered(const SourceView<T>& source,
                                Filter filter,
                                const SourcePosition<ArithmeticOf<T>>& at,
                                T* out) {
  const auto taps = filter_taps(source, filter, at);
  const bool is_center = at.fraction[0] == 0 && at.fraction[1] == 0 && at.fraction[2] == 0;
  for (int c = 0; c < source.components; ++c) {
    if (is_center) {
      out[c] = source.data[taps.near + c];
    } else if (filter == Filter::lanczos) {
      out[c] = finished(source, filtered<6>(taps, source.data + c), c);
    } else if (filter == Filter::cubic) {
      out[c] = finished(source, filtered<4>(taps, source.data + c), c);
    } else {
      out[c] = finished(source, filtered<4>(taps, source.coefficients + c), c);
    }
  }
}

}  // namespace tetwarp
