/// @file sample.cpp
/// Weights of filters, coefficients of splines, and samples with the rules for the border.
#include "host/reference/warp/sample.hpp"

#include <numbers>

namespace tetwarp::reference {
namespace {
/// sin(pi x) / (pi x)
double sinc(double x) {
  if (x == 0) return 1;
  if (x == std::nearbyint(x)) return 0;
  return std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

/// Piecewise cubic of R. Keys (1981), a = -1/2.
double cubic_convolution(double x) {
  if (x < 1) return 1.5 * x * x * x - 2.5 * x * x + 1;
  return x < 2 ? -0.5 * x * x * x + 2.5 * x * x - 4 * x + 2 : 0;
}

double cubic_bspline(double x) {
  if (x < 1) return 2.0 / 3 - x * x + x * x * x / 2;
  return x < 2 ? (2 - x) * (2 - x) * (2 - x) / 6 : 0;
}

/// Solves c[i-1] + 4 c[i] + c[i+1] = 6 s[i], where c[-1] = c[1] and c[n] = c[n-2], by elimination.
void solve_line(double* line, std::int64_t step, std::int64_t n) {
  if (n == 1) return;
  std::vector<double> upper(static_cast<std::size_t>(n));
  for (std::int64_t i = 0; i < n; ++i) {
    const double below = i == 0 ? 0 : i == n - 1 ? 2 : 1, above = i == 0 ? 2 : 1;
    const double before = i == 0 ? 0 : line[(i - 1) * step];
    const double pivot = 4 - (i == 0 ? 0 : below * upper[static_cast<std::size_t>(i - 1)]);
    upper[static_cast<std::size_t>(i)] = above / pivot;
    line[i * step] = (6 * line[i * step] - below * before) / pivot;
  }
  for (std::int64_t i = n - 2; i >= 0; --i) {
    line[i * step] -= upper[static_cast<std::size_t>(i)] * line[(i + 1) * step];
  }
}

/// Replaces samples that are not finite by the previous one, at the beginning by the next finite
/// one.
void bridge_gaps(double* row, std::int64_t step, std::int64_t n) {
  const auto is_gap = [&](std::int64_t i) { return !std::isfinite(row[i * step]); };
  std::int64_t first = 0;
  while (first < n && is_gap(first)) ++first;
  const double leading = first < n ? row[first * step] : 0;
  for (std::int64_t i = 0; i < n; ++i) {
    if (is_gap(i)) row[i * step] = i < first ? leading : row[(i - 1) * step];
  }
}
}  // namespace

double weight_of(Filter filter, double distance) {
  const double x = std::abs(distance);
  switch (filter) {
    case Filter::nearest:
      return x <= 0.5 ? 1 : 0;
    case Filter::cubic:
      return cubic_convolution(x);
    case Filter::bspline:
      return cubic_bspline(x);
    case Filter::lanczos:
      return x < 3 ? sinc(x) * sinc(x / 3) : 0;
    default:
      return x < 1 ? 1 - x : 0;
  }
}

int radius_of(Filter filter) {
  if (filter == Filter::lanczos) return 3;
  return filter == Filter::cubic || filter == Filter::bspline ? 2 : 1;
}

std::int64_t stand_in(Filter filter, std::int64_t i, std::int64_t n) {
  if (filter != Filter::bspline) return std::clamp(i, std::int64_t{0}, n - 1);
  while (n > 1 && (i < 0 || i >= n)) i = i < 0 ? -i : 2 * (n - 1) - i;
  return n > 1 ? i : 0;
}

std::vector<double> spline_coefficients(std::vector<double> samples,
                                        const std::array<std::int64_t, 3>& dims,
                                        int components) {
  std::int64_t step = components;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t n = dims[axis];
    const auto count = static_cast<std::int64_t>(samples.size());
    for (std::int64_t layer = 0; layer < count; layer += step * n) {
      for (std::int64_t line = layer; line < layer + step; ++line) {
        if (axis == 0) bridge_gaps(samples.data() + line, step, n);
        solve_line(samples.data() + line, step, n);
      }
    }
    step *= n;
  }
  return samples;
}

}  // namespace tetwarp::reference
