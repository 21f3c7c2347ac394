/// @file residual_check.cuh
/// The check of an iterate of the two-level iteration in one launch of a grid that synchronizes
/// itself.
#pragma once
#include <cstdint>

#include "kernels/body/island_team.cuh"
#include "kernels/contact/compliant_gradients.hpp"
#include "kernels/contact/residual_check.hpp"

namespace tetwarp {

/// In a launch: lanes of a warp share an index.
template <class Team, class Op>
__device__ __forceinline__ void gradient_by_lanes(IslandExec<Team>& exec,
                                                  const char*,
                                                  std::int64_t count,
                                                  const Op& op) {
  static_assert(Op::lanes == 32);
  exec.for_each_by_warps(count, [&](std::int64_t i) {
    const auto sum = warp_sum(op.part(i / 32, static_cast<int>(i % 32)));
    if (i % 32 == 0) op.finish(i / 32, sum);
  });
}

struct ResidualCheckState {
  CausedProgress progress;
  double eta = 0;  ///< where the velocities are found
};

struct ResidualCheckJob {
  CompliantGradients system;  ///< its r, in: the defect; a check that goes on takes all vectors as
                              ///< the launch before has left them
  TouchingRows touching;
  View<const double> velocity;  ///< v, [rows][3]
  CheckedContacts contacts;
  View<const ContactConstants<double>> lower;
  ContactSwitches switches;
  View<double> caused;  ///< work, J v' + w, [3 contacts]
  double negligible, least_scale;
  std::int64_t most;  ///< iterations of the launch
  bool is_first;      ///< whether the check begins
  void* sums;         ///< [GridTeam::sum_bytes(most_terms)]
  std::int64_t most_terms;
  ResidualCheckState* state;  ///< in, unless the check begins, and out
};

/// Blocks: as many as are resident together, at most. Threads: sum_threads. Shared:
/// GridTeam::shared_bytes, dynamic. Registers: up to 255.
/// @tparam Team  GridTeam
template <class Team>
__global__ void __launch_bounds__(sum_threads, 2) residual_check_kernel(ResidualCheckJob job) {
  const CompliantGradients& system = job.system;
  IslandExec<Team> exec(nullptr,
                        GridTeam(job.sums, job.most_terms, dynamic_shared<unsigned char>()));
  ResidualCheckState state;
  if (job.is_first) {
    exec.for_each("", system.x.size, [&](std::int64_t i) { system.x[i] = 0; });
  } else {
    state = *job.state;
  }
  find_caused(exec, system, 0, system.x.size / 3, job.negligible, job.most, state.progress);
  if (state.progress.end == CausedProgress::End::found) {
    exec.for_each("", system.x.size / 3, RowMoveOp{system.of, system.x, job.velocity, system.q});
    exec.for_each("", job.caused.size / 3, TouchVelocityOp{job.touching, system.q, job.caused});
    const auto sums = exec.template sum<PlainSums<3>>(
        "", 0, job.caused.size / 3,
        caused_error(job.contacts, job.lower, job.switches, job.caused));
    state.eta = caused_eta(sums, job.least_scale);
  }
  if (exec.first() == 0) *job.state = state;
}

}  // namespace tetwarp
