/// @file operator_taps.cpp
/// Slopes of the filters by their formulas.
#include "host/warp/cpu/operator_taps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {
namespace {
/// sin(pi x) / (pi x) and its derivative.
struct Sinc {
  double value, slope;

  explicit Sinc(double x) {
    constexpr double pi = std::numbers::pi, small = 1e-4;  // where the series is exact to rounding
    const double square = pi * pi * x * x;
    if (std::abs(x) < small) {
      value = 1 - square / 6 * (1 - square / 20);
      slope = -pi * pi * x / 3 * (1 - square / 10);
    } else {
      value = std::sin(pi * x) / (pi * x);
      slope = (std::cos(pi * x) - value) / x;
    }
  }
};

/// Derivatives of lanczos_weights(): of g_i / sum of g, with g(x) = sinc(x) sinc(x / 3).
void lanczos_slopes(double t, double* slopes) {
  double value[6], total = 0, total_slope = 0;
  for (int i = 0; i < 6; ++i) {
    const double x = t + 2 - i;
    const Sinc wave(x), window(x / 3);
    value[i] = wave.value * window.value;
    slopes[i] = wave.slope * window.value + wave.value * window.slope / 3;
    total += value[i];
    total_slope += slopes[i];
  }
  for (int i = 0; i < 6; ++i) {
    slopes[i] = (slopes[i] - value[i] / total * total_slope) / total;
  }
}

/// Derivatives of filter_weights() by t.
void filter_slopes(Filter filter, double t, double* slopes) {
  const double u = 1 - t;
  if (filter == Filter::cubic) {
    slopes[0] = (-1.5 * t + 2) * t - 0.5;
    slopes[1] = (4.5 * t - 5) * t;
    slopes[2] = (-4.5 * t + 4) * t + 0.5;
    slopes[3] = (1.5 * t - 1) * t;
  } else if (filter == Filter::bspline) {
    slopes[0] = -0.5 * u * u;
    slopes[1] = (1.5 * t - 2) * t;
    slopes[2] = (2 - 1.5 * u) * u;
    slopes[3] = 0.5 * t * t;
  } else {
    lanczos_slopes(t, slopes);
  }
}

/// Sets weights and slopes along one axis. @returns index of the first tap, from the voxel below
int set_weights(Filter filter, double t, int axis, OperatorTaps& taps) {
  double* const weight = taps.weight[axis];
  double* const slope = taps.slope[axis];
  if (filter == Filter::nearest) {
    taps.count[axis] = 1;
    weight[0] = 1;
    return t < 0.5 ? 0 : 1;
  }
  if (filter == Filter::linear && t == 0) {  // the mean of the slopes on both sides
    taps.count[axis] = 3;
    for (int i = 0; i < 3; ++i) {
      weight[i] = i == 1 ? 1 : 0;
      slope[i] = 0.5 * (i - 1);
    }
    return -1;
  }
  if (filter == Filter::linear) {
    taps.count[axis] = 2;
    weight[0] = 1 - t;
    weight[1] = t;
    slope[0] = -1;
    slope[1] = 1;
    return 0;
  }
  taps.count[axis] = tap_count(filter);
  filter_weights(filter, t, weight);
  filter_slopes(filter, t, slope);
  return 1 - tap_count(filter) / 2;
}
}  // namespace

bool set_taps(const std::array<std::int64_t, 3>& dims,
              Filter filter,
              const SourcePlace& place,
              OperatorTaps& taps) {
  SourceView<double> source = {};
  for (int axis = 0; axis < 3; ++axis) {
    source.dims[axis] = static_cast<int>(dims[static_cast<std::size_t>(axis)]);
    if (!is_defined(source, axis, place.whole[axis], place.at[axis])) return false;
  }
  std::int64_t stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const int last = source.dims[axis] - 1;
    const double lower = std::floor(place.at[axis]);
    const int first = place.whole[axis] + static_cast<int>(lower) +
                      set_weights(filter, place.at[axis] - lower, axis, taps);
    for (int i = 0; i < taps.count[axis]; ++i) {
      const int voxel = first + i;
      taps.offset[axis][i] =
          (filter == Filter::bspline ? mirrored(voxel, last) : std::clamp(voxel, 0, last)) * stride;
    }
    stride *= dims[static_cast<std::size_t>(axis)];
  }
  return true;
}

}  // namespace tetwarp
