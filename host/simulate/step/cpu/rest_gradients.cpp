/// @file rest_gradients.cpp
/// The iteration, with factors at rest as its preconditioner.
#include "host/simulate/step/cpu/rest_gradients.hpp"

#include <algorithm>

#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t most_iterations = 60;

/// Sum of x y over the numbers of the rows.
double product(View<const double> x, View<const double> y, std::int64_t begin, std::int64_t end) {
  double sum = 0;
  for (std::int64_t k = 3 * begin; k < 3 * end; ++k) sum += x[k] * y[k];
  return sum;
}

/// |r|^2 in the norm of D^-1.
double square(const GradientArrays<double>& a,
              View<const double> r,
              std::int64_t begin,
              std::int64_t end) {
  double sum = 0;
  for (std::int64_t row = begin; row < end; ++row) {
    double z[6];
    const int count = a.inverse.multiply(row, r.data + 3 * row, z);
    for (int i = 0; i < count; ++i) sum += r[3 * row + i] * z[i];
  }
  return sum;
}

}  // namespace

RestGradients::RestGradients(const Model& model, std::shared_ptr<RestFactors> factors)
    : factors_(factors ? std::move(factors) : std::make_shared<RestFactors>(model)) {}

void RestGradients::begin(double time_step, const double* position) {
  factors_->set_time_step(time_step);
  position_ = position;
}

std::int64_t RestGradients::solve(const GradientArrays<double>& a,
                                  std::int32_t island,
                                  std::int64_t begin,
                                  std::int64_t end,
                                  const GradientOptions& options) {
  RestFactor& factor = factors_->of_body(factors_->body_of_island(island));
  const std::array<double, 9> rotation = factor.mean_rotation(position_);
  const auto precondition = [&] {
    factor.solve_turned(rotation, a.r.data + 3 * begin, a.z.data + 3 * begin);
  };
  std::copy_n(a.x.data + 3 * begin, 3 * (end - begin), a.p.data + 3 * begin);
  vector_stages().product(a, begin, end);
  for (std::int64_t k = 3 * begin; k < 3 * end; ++k) a.r[k] = a.load[k] - a.q[k];
  const double target = square_of(options.tolerance / 2) * square(a, a.load, begin, end);
  precondition();
  std::copy_n(a.z.data + 3 * begin, 3 * (end - begin), a.p.data + 3 * begin);
  double along = product(a.r, a.z, begin, end);
  const std::int64_t most = std::min(most_iterations, options.max_iterations);
  for (std::int64_t iteration = 1; iteration <= most; ++iteration) {
    vector_stages().product(a, begin, end);
    const double curvature = product(a.p, a.q, begin, end);
    if (!(curvature > 0 && along > 0)) return iteration - 1;
    const double step = along / curvature;
    for (std::int64_t k = 3 * begin; k < 3 * end; ++k) {
      a.x[k] += step * a.p[k];
      a.r[k] -= step * a.q[k];
    }
    if (square(a, a.r, begin, end) <= target) return iteration;
    precondition();
    const double next = product(a.r, a.z, begin, end);
    for (std::int64_t k = 3 * begin; k < 3 * end; ++k) a.p[k] = a.z[k] + next / along * a.p[k];
    along = next;
  }
  return most;
}

}  // namespace tetwarp
