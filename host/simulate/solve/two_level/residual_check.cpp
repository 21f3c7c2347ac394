/// @file residual_check.cpp
/// The rows of the iteration as a system of conjugate gradients.
#include "host/simulate/solve/two_level/residual_check.hpp"

#include <algorithm>
#include <limits>

#include "host/base/vector_view.hpp"
#include "host/exec/exec_cpu.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t asked_after = 10;  // iterations

/// All rows as one index.
struct StepGradients {
  using Number = double;

  const TwoLevelStep& step;
  View<double> x, r, z, p, q;

  static const char* label() { return "body/contact"; }
  NumberRange numbers(std::int64_t) const { return {0, x.size}; }
  NumberRange coupled(std::int64_t i) const { return numbers(i); }
  double multiply(std::int64_t) const {
    step.multiply(p.data, q.data);
    double sum = 0;
    for (std::int64_t i = 0; i < p.size; ++i) sum += p[i] * q[i];
    return sum;
  }
  void precondition(std::int64_t) const { step.solve(r.data, z.data); }
};

}  // namespace

void ResidualCheck::set(const CompliantLists& lists, const std::vector<double>& free) {
  free_ = &free;
  is_needed_ = lists.has_joined();
  if (!is_needed_) return;
  lower_.resize(free.size() / 3);
  zeros_.assign(free.size(), 0.0);
  CompliantBodies of;
  of.bodies = view_of(lists.bodies);
  of.body_of_row = view_of(lists.body_of_row);
  CpuExec(1, StageClocks::off)
      .for_each("body/contact", blocks_.count(),
                LowerTouchOp{of, blocks_.rows(), blocks_.constants(), view_of(lower_)});
}

bool ResidualCheck::find_caused_velocities(const std::vector<double>& x,
                                           double negligible,
                                           const std::function<bool()>& goes_on) {
  solution_ = x;
  defect_ = step_.defect();
  for (auto* values : {&preconditioned_, &direction_, &product_}) values->resize(x.size());
  const StepGradients system{step_,
                             view_of(solution_),
                             view_of(defect_),
                             view_of(preconditioned_),
                             view_of(direction_),
                             view_of(product_)};
  CpuExec exec(1, StageClocks::off);
  CausedProgress progress;
  while (progress.end == CausedProgress::End::open) {
    find_caused(exec, system, 0, 1, negligible, asked_after, progress);
    if (progress.end == CausedProgress::End::open && !goes_on()) return false;
  }
  return progress.end == CausedProgress::End::found;
}

double ResidualCheck::run(const std::vector<double>& x,
                          const std::vector<double>& impulse,
                          const std::vector<double>& velocity,
                          double work,
                          const ResidualCheckLimits& limits,
                          const std::function<bool()>& goes_on) {
  if (!find_caused_velocities(x, limits.negligible(work), goes_on)) {
    return std::numeric_limits<double>::infinity();
  }
  velocity_.resize(impulse.size());
  blocks_.velocities_of_rows(solution_, velocity_);
  const CheckedContacts contacts{view_of(impulse), view_of(velocity), view_of(*free_),
                                 view_of(zeros_)};
  const auto sums =
      CpuExec(1, StageClocks::off)
          .sum<PlainSums<3>>("body/contact", 0, blocks_.count(),
                             caused_error(contacts, view_of(std::as_const(lower_)), switches_,
                                          view_of(std::as_const(velocity_))));
  return caused_eta(sums, limits.least_scale);
}

}  // namespace tetwarp
