/// @file volume_prefilter.hpp
/// Coefficients of the cubic B-spline that interpolates the samples of a source, mirrored at its
/// border; once per source.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/sample/volume_filter.hpp"
#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {

constexpr double spline_pole = -0.26794919243112270647;  ///< sqrt(3) - 2
constexpr int spline_memory = 32;                        ///< the pole to this power is below 2^-60
constexpr int spline_bundle = 8;  ///< adjacent lines filtered together: one cache line of samples

/// Solves (c[i-1] + 4 c[i] + c[i+1]) / 6 = s[i] along lines in place, by a forward and a backward
/// recursion: with the pole z, p[i] = 6 s[i] + z p[i-1], then c[i] = z (c[i+1] - p[i]).
/// @param line   sample 0 of the first of `width` lines that are adjacent in memory
/// @param step   distance in memory of consecutive samples of a line
/// @param count  samples per line
/// @param width  number of lines, at most spline_bundle
TETWARP_HD void prefilter_lines(double* line, std::int64_t step, int count, int width) {
  constexpr double z = spline_pole;
  if (count == 1) return;
  double state[spline_bundle];
  double power = 1;
  for (int l = 0; l < width; ++l) state[l] = 0;
  for (int i = 0; i < spline_memory; ++i, power *= z) {  // mirrored samples before the first
    const double* const at = line + mirrored(i, count - 1) * step;
    for (int l = 0; l < width; ++l) state[l] = add_rn(state[l], mul_rn(6 * power, at[l]));
  }
  for (int l = 0; l < width; ++l) line[l] = state[l];
  for (int i = 1; i < count; ++i) {
    double* const at = line + i * step;
    for (int l = 0; l < width; ++l) {
      state[l] = add_rn(mul_rn(6, at[l]), mul_rn(z, state[l]));
      at[l] = state[l];
    }
  }
  const std::int64_t last = (count - 1) * step;
  for (int l = 0; l < width; ++l) {
    state[l] = mul_rn(z / (z * z - 1), add_rn(mul_rn(z, line[last - step + l]), state[l]));
    line[last + l] = state[l];
  }
  for (int i = count - 2; i >= 0; --i) {
    double* const at = line + i * step;
    for (int l = 0; l < width; ++l) {
      state[l] = mul_rn(z, add_rn(state[l], -at[l]));
      at[l] = state[l];
    }
  }
}

/// One index = one component of one row of samples; any order. Copies the row to `work` and filters
/// it.
///
/// A sample that is not finite is replaced by the previous finite one of the row, or else the next,
/// so that coefficients of its neighbors stay finite.
template <class T>
struct SplineRowOp {
  SourceView<T> source;
  View<double> work;

  TETWARP_HD void operator()(std::int64_t line) const {
    const int components = source.components, count = source.dims[0];
    const std::int64_t first = line / components * count * components + line % components;
    const T* const from = source.data + first;
    double* const to = work.data + first;
    double before = 0;
    for (int i = count - 1; i >= 0; --i) {  // afterwards `before` is the first finite one
      const double sample = static_cast<double>(from[std::int64_t{i} * components]);
      if (is_finite(sample)) before = sample;
    }
    for (int i = 0; i < count; ++i) {
      const double sample = static_cast<double>(from[std::int64_t{i} * components]);
      if (is_finite(sample)) before = sample;
      to[std::int64_t{i} * components] = before;
    }
    prefilter_lines(to, components, count, 1);
  }

  TETWARP_HD static bool is_finite(double sample) { return sample - sample == 0; }
};

/// One index = a bundle of adjacent lines along y or z; any order.
struct SplineLinesOp {
  View<double> work;
  std::int64_t step;  ///< distance of a line's samples; also the number of adjacent lines
  int count;          ///< samples per line

  TETWARP_HD void operator()(std::int64_t bundle) const {
    const std::int64_t per_layer = bundles_of(step);
    const std::int64_t layer = bundle / per_layer;
    const std::int64_t first = (bundle - layer * per_layer) * spline_bundle;
    prefilter_lines(work.data + layer * step * count + first, step, count,
                    static_cast<int>(min_of(step - first, std::int64_t{spline_bundle})));
  }

  TETWARP_HD static std::int64_t bundles_of(std::int64_t lines) {
    return (lines + spline_bundle - 1) / spline_bundle;
  }
};

/// One index = one sample; any order. Converts a coefficient to Real. A coefficient close to its
/// sample is replaced by the sample, as is that of a sample that is not finite.
template <class T>
struct SplineStoreOp {
  using Real = ArithmeticOf<T>;
  View<const T> samples;
  View<const double> work;
  double tolerance;
  View<Real> coefficients;  ///< may be `work`

  TETWARP_HD void operator()(std::int64_t s) const {
    const double sample = static_cast<double>(samples[s]);
    const bool is_close = !(fabs(work[s] - sample) > tolerance);  // true for NaN
    const bool is_finite = SplineRowOp<T>::is_finite(sample);
    coefficients[s] = static_cast<Real>(is_finite && !is_close ? work[s] : sample);
  }
};

/// Computes the coefficients in float64, rounded once at the end.
///
/// In constant regions coefficients converge to the samples but never reach them; with a tolerance
/// they become equal, so that such regions are found to be constant (volume_uniform.hpp).
/// @param exec          where to run
/// @param source        the samples
/// @param tolerance     coefficients this close to their samples are replaced by them [sample]
/// @param work          scratch, one per sample; may be `coefficients` if these are float64
/// @param coefficients  out, one per sample, in the same order
///
/// Determinism: same bits on every back end. Cost: three reads and writes of `work`, one of the
/// source and of the coefficients.
/// Source: M. Unser, "Splines: a perfect fit for signal and image processing", 1999.
template <class Exec, class T>
void volume_prefilter(Exec& exec,
                      const SourceView<T>& source,
                      double tolerance,
                      View<double> work,
                      View<ArithmeticOf<T>> coefficients) {
  const std::int64_t row = std::int64_t{source.dims[0]} * source.components;
  const std::int64_t slice = row * source.dims[1];
  exec.for_each("warp/setup", work.size / source.dims[0], SplineRowOp<T>{source, work});
  exec.for_each("warp/setup", SplineLinesOp::bundles_of(row) * source.dims[2],
                SplineLinesOp{work, row, source.dims[1]});
  exec.for_each("warp/setup", SplineLinesOp::bundles_of(slice),
                SplineLinesOp{work, slice, source.dims[2]});
  exec.for_each("warp/setup", work.size,
                SplineStoreOp<T>{{source.data, work.size}, work, tolerance, coefficients});
}

}  // namespace tetwarp
