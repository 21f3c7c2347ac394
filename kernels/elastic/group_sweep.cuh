/// @file group_sweep.cuh
/// Projected Gauss-Seidel over the contacts of groups that share no body: one block of a device for
/// each group.
#pragma once
#include <cstdint>

#include "kernels/elastic/contact_groups.hpp"
#include "kernels/exec/block_sum.cuh"

namespace tetwarp {

constexpr std::int64_t most_group_contacts = 1024;  ///< of a group: their velocities are shared

struct GroupSweep {
  ContactGroups of;
  View<const ContactConstants<double>> constants;
  ContactSwitches switches;
  View<const float> units, matrix;
  View<double> node_velocity;  ///< in and out, [nodes][3] in frames
  View<double> impulse;        ///< in and out, [3 contacts]
  View<double> before;         ///< out: impulses before the sweep
};

/// u of the contacts of a group from the velocities of its nodes.
__device__ __forceinline__ void load_group(const GroupSweep& job,
                                           const ContactGroup& group,
                                           double* velocity) {
  const TouchingRows& touching = job.of.touching;
  for (std::int64_t k = threadIdx.x; k < group.contact_count(); k += sum_threads) {
    const std::int64_t c = group.contact_begin + k;
    for (int a = 0; a < 3; ++a) {
      double u = touching.offset[3 * c + a];
      for (std::int64_t b = touching.block_start[c]; b < touching.block_start[c + 1]; ++b) {
        const double* const j = job.of.turned.data + 9 * b + 3 * a;
        const double* const v = job.node_velocity.data + 3 * std::int64_t{touching.node[b]};
        u += j[0] * v[0] + j[1] * v[1] + j[2] * v[2];
      }
      velocity[3 * k + a] = u;
      job.before[3 * c + a] = job.impulse[3 * c + a];
    }
  }
}

/// Adds the velocities that the changes of impulses cause to the nodes of a group.
__device__ __forceinline__ void store_group(const GroupSweep& job, const ContactGroup& group) {
  const std::int64_t width = 3 * std::int64_t{group.node_count};
  const std::int64_t first = 3 * std::int64_t{group.contact_begin};
  for (std::int64_t i = threadIdx.x; i < width; i += sum_threads) {
    const float* unit = job.units.data + group.units + i;
    double sum = 0;
    for (std::int64_t n = 0; n < 3 * group.contact_count(); ++n, unit += width) {
      sum += double{*unit} * (job.impulse[first + n] - job.before[first + n]);
    }
    job.node_velocity[3 * job.of.node_at(group, i / 3) + i % 3] += sum;
  }
}

/// Blocks: one per group. Threads: sum_threads. Shared: velocities of a group's contacts, [3] each,
/// and a change, [3]. Registers: up to 128.
__global__ void __launch_bounds__(sum_threads, 4)
    group_sweep_kernel(GroupSweep job, std::int64_t first_group) {
  double* const change = dynamic_shared<double>();
  double* const velocity = change + 3;
  const ContactGroup group = job.of.groups[first_group + static_cast<std::int64_t>(blockIdx.x)];
  load_group(job, group, velocity);
  __syncthreads();
  const std::int64_t stride = 3 * group.contact_count();
  for (int pass = 0; pass < group.passes; ++pass) {
    for (std::int64_t k = 0; k < group.contact_count(); ++k) {
      const std::int64_t c = group.contact_begin + k;
      if (threadIdx.x == 0) {
        double* const r = job.impulse.data + 3 * c;
        double u[3];
        for (int a = 0; a < 3; ++a) {
          u[a] = velocity[3 * k + a];
          change[a] = -r[a];
        }
        solve_contact(job.constants[c], job.switches, u, r);
        for (int a = 0; a < 3; ++a) change[a] += r[a];
      }
      __syncthreads();
      const double own[3] = {change[0], change[1], change[2]};
      if (own[0] != 0 || own[1] != 0 || own[2] != 0) {
        const float* const rows = job.matrix.data + group.matrix + 3 * k * stride;
        for (std::int64_t i = threadIdx.x; i < stride; i += sum_threads) {
          velocity[i] += double{rows[i]} * own[0] + double{rows[stride + i]} * own[1] +
                         double{rows[2 * stride + i]} * own[2];
        }
      }
      __syncthreads();
    }
  }
  store_group(job, group);
}

}  // namespace tetwarp
