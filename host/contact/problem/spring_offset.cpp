/// @file spring_offset.cpp
/// The impulses kappa_n o_n, moved into a problem and out of its solution.
#include "host/contact/problem/spring_offset.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "kernels/contact/check_limits.hpp"

namespace tetwarp {

std::vector<double> normal_offsets(const ContactProblem& problem) {
  const AdhesionState& adhesion = problem.adhesion;
  if (problem.is_local() || adhesion.gap.empty() || !(adhesion.time_step > 0)) return {};
  double scale = 0;
  for (const double gap : adhesion.gap) scale = std::max(scale, std::abs(gap));
  for (std::size_t c = 0; c < problem.friction.size(); ++c) {
    scale = std::max(scale, std::abs(adhesion.time_step * problem.velocity_offset[3 * c]));
  }
  std::vector<double> offsets(problem.friction.size(), 0.0);
  bool is_any = false;
  for (std::size_t c = 0; c < offsets.size(); ++c) {
    const double difference =
        adhesion.gap[3 * c] - adhesion.time_step * problem.velocity_offset[3 * c];
    if (std::abs(difference) <= spring_rounding.host * scale) continue;
    offsets[c] = difference / adhesion.time_step;
    is_any = true;
  }
  if (!is_any) offsets.clear();
  return offsets;
}

std::vector<double> spring_preloads(const ContactProblem& problem) {
  const AdhesionState& adhesion = problem.adhesion;
  if (adhesion.empty() || adhesion.area.empty() || adhesion.stiffness.empty()) return {};
  std::vector<double> preloads = normal_offsets(problem);
  bool is_any = false;
  for (std::size_t c = 0; c < preloads.size(); ++c) {
    const double beta = adhesion.intensity[c];
    preloads[c] *= adhesion.time_step * adhesion.time_step * adhesion.area[c] * beta * beta *
                   adhesion.stiffness[c];
    is_any = is_any || preloads[c] != 0;
  }
  if (!is_any) preloads.clear();
  return preloads;
}

ContactProblem with_preloads(ContactProblem problem, const std::vector<double>& preloads) {
  const SparseMatrix& jacobian = problem.jacobian;
  for (std::size_t c = 0; c < preloads.size(); ++c) {
    for (std::int64_t e = jacobian.row_start[3 * c]; e < jacobian.row_start[3 * c + 1]; ++e) {
      problem.load[index_of(jacobian.column[index_of(e)])] -=
          jacobian.value[index_of(e)] * preloads[c];
    }
    problem.adhesion.gap[3 * c] = problem.adhesion.time_step * problem.velocity_offset[3 * c];
  }
  add_preloads(preloads, 1, problem.impulse_guess);
  return problem;
}

void add_preloads(const std::vector<double>& preloads, double sign, std::vector<double>& impulse) {
  if (impulse.empty()) return;
  for (std::size_t c = 0; c < preloads.size(); ++c) impulse[3 * c] += sign * preloads[c];
}

}  // namespace tetwarp
