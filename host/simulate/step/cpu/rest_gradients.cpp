/// @file rest_gradients.cpp
/// The iteration, with factors at rest as its preconditioner.
#include "host/simulate/step/cpu/rest_gradients.hpp"

#include <algorithm>
#include <span>

#include "host/base/index_of.hpp"
#include "host/exec/exec_cpu.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t most_iterations = 60;

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

/// The rows [begin, end) of an island as one index of conjugate gradients.
struct RestSystem {
  using Number = double;

  const GradientArrays<double>& a;
  std::int64_t begin, end;
  std::span<const RestGradients::TurnedFactor> bodies;  ///< in the order of their rows
  View<double> x, r, z, p, q;
  double target = 0;  ///< z is zero, which ends a solve, where |r|^2 is not larger

  static const char* label() { return gradient_label(); }
  NumberRange numbers(std::int64_t) const { return {3 * begin, 3 * end}; }
  NumberRange coupled(std::int64_t i) const { return numbers(i); }
  double multiply(std::int64_t) const { return vector_stages().product(a, begin, end).value[0]; }
  void precondition(std::int64_t) const {
    if (target > 0 && square(a, r, begin, end) <= target) {
      std::fill_n(z.data + 3 * begin, 3 * (end - begin), 0.0);
      return;
    }
    std::int64_t first = 3 * begin;
    for (const auto& own : bodies) {
      own.factor->solve_turned(own.rotation, r.data + first, z.data + first);
      first += 3 * std::int64_t{own.factor->node_count()};
    }
  }
};

}  // namespace

RestGradients::RestGradients(const Model& model, std::shared_ptr<RestFactors> factors)
    : factors_(factors ? std::move(factors) : std::make_shared<RestFactors>(model)),
      turned_(index_of(model.island_count)) {}

void RestGradients::begin(double time_step, const double* position) {
  factors_->set_time_step(time_step);
  position_ = position;
}

std::int64_t RestGradients::solve(const GradientArrays<double>& a,
                                  std::int32_t island,
                                  std::int64_t begin,
                                  std::int64_t end,
                                  const GradientOptions& options) {
  std::vector<TurnedFactor>& turned = turned_[index_of(island)];
  turned.clear();
  for (const std::int32_t body : factors_->bodies_of_island(island)) {
    RestFactor& factor = factors_->of_body(body);
    turned.push_back({&factor, factor.mean_rotation(position_)});
  }
  RestSystem system{a, begin, end, turned, a.x, a.r, a.z, a.p, a.q};
  std::copy_n(a.x.data + 3 * begin, 3 * (end - begin), a.p.data + 3 * begin);
  system.multiply(0);
  for (std::int64_t k = 3 * begin; k < 3 * end; ++k) a.r[k] = a.load[k] - a.q[k];
  CpuExec exec(1, StageClocks::off);
  GradientScalars scalars{};
  gradient_start(exec, system, 0, 1, &scalars.square);
  system.target = square_of(options.tolerance / 2) * square(a, a.load, begin, end);
  const GradientIteration<RestSystem> next{system, 0, 1, &scalars, &scalars.square};
  const std::int64_t most = std::min(most_iterations, options.max_iterations);
  std::int64_t iterations = 0;
  while (iterations < most && scalars.square.value[0] > 0) {
    next.run(exec);
    if (scalars.step == 0) break;
    ++iterations;
  }
  return iterations;
}

}  // namespace tetwarp
