/// @file delassus_lanes.cuh
/// Long rows of a Delassus matrix by the lanes of a warp: in condensed islands every contact
/// influences all others. The lanes compute the products of 32 blocks at once, and each of them
/// adds all products in their order: velocities have the bits of DelassusView::velocity_at().
#pragma once
#include <cstdint>

#include "kernels/contact/contact_sweep.hpp"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/exec/island_exec.cuh"

namespace tetwarp {

/// Whether rows have as many blocks as a warp has lanes, in the mean over the problem.
template <class T>
TETWARP_HD bool has_long_rows(const DelassusView<T>& delassus) {
  return delassus.column.size >= 32 * (delassus.row_start.size - 1);
}

/// u = q + W r at contact c.
/// @param velocity  out: u, [3], of every lane
/// @pre all lanes of the warp call it
template <class T>
__device__ __forceinline__ void velocity_by_lanes(
    const DelassusView<T>& delassus, std::int64_t c, int lane, const T* impulse, T* velocity) {
  for (int a = 0; a < 3; ++a) velocity[a] = delassus.free_velocity[3 * c + a];
  const std::int64_t end = delassus.row_start[c + 1];
  for (std::int64_t first = delassus.row_start[c]; first < end; first += 32) {
    const std::int64_t k = first + lane;
    T product[3] = {};
    if (k < end) {
      const T* const w = delassus.blocks.data + 9 * k;
      const T* const r = impulse + 3 * std::int64_t{delassus.column[k]};
      for (int a = 0; a < 3; ++a) {
        product[a] = w[3 * a] * r[0] + w[3 * a + 1] * r[1] + w[3 * a + 2] * r[2];
      }
    }
    const int count = static_cast<int>(min_of(end - first, std::int64_t{32}));
    for (int other = 0; other < count; ++other) {
      for (int a = 0; a < 3; ++a) velocity[a] += __shfl_sync(~0u, product[a], other);
    }
  }
}

/// A velocity in place of a DelassusView.
template <class T>
struct KnownVelocity {
  T velocity[3];

  TETWARP_HD void velocity_at(std::int64_t, const T*, T* out) const {
    for (int a = 0; a < 3; ++a) out[a] = velocity[a];
  }
  TETWARP_HD T normal_velocity_at(std::int64_t, const T*) const { return velocity[0]; }
};

/// One index = one lane of a contact; see DelassusSweepOp.
template <class T>
struct DelassusSweepLanesOp {
  static constexpr int lanes = 32;

  DelassusSweepOp<T> of;
  bool operator==(const DelassusSweepLanesOp&) const = default;

  __device__ void operator()(std::int64_t i) const {
    const std::int64_t c = i / lanes;
    const int lane = static_cast<int>(i % lanes);
    if (__any_sync(~0u, lane == 0 && of.frozen.skips(c))) return;
    KnownVelocity<T> known;
    velocity_by_lanes(of.delassus, c, lane, of.impulse.data, known.velocity);
    __syncwarp();  // all lanes have read the impulses
    if (lane != 0) return;
    T change[3];
    T* const r = of.impulse.data + 3 * c;
    update_contact<KnownVelocity<T>, T>(of.constants[c], of.switches, known, c, nullptr, r, change);
    of.frozen.note(c, change, r);
  }
};

/// One index = one lane of a contact: its velocity.
template <class T>
struct DelassusVelocityLanesOp {
  static constexpr int lanes = 32;

  ContactVelocityOp<DelassusView<T>, T> of;

  __device__ void operator()(std::int64_t i) const {
    const std::int64_t c = i / lanes;
    const int lane = static_cast<int>(i % lanes);
    T velocity[3];
    velocity_by_lanes(of.velocities, c, lane, of.cause, velocity);
    if (lane == 0) {
      for (int a = 0; a < 3; ++a) of.velocity[3 * c + a] = velocity[a];
    }
  }
};

/// As contact_sweep() of any executor, by the threads of a team.
template <class Team, class T>
__device__ __forceinline__ void contact_sweep(IslandExec<Team>& exec,
                                              View<const std::int64_t> color_start,
                                              const DelassusSweepOp<T>& op) {
  const bool by_lanes = has_long_rows(op.delassus);
  for (std::int64_t k = 0; k + 1 < color_start.size; ++k) {
    const std::int64_t first = color_start[k], count = color_start[k + 1] - first;
    if (by_lanes) {
      exec.for_each_by_warps(count, FromIndex<DelassusSweepLanesOp<T>>{{op}, 32 * first});
    } else {
      exec.for_each("contact/sweep", count, FromIndex<DelassusSweepOp<T>>{op, first});
    }
  }
}

/// As contact_velocities() of any executor.
template <class Team, class T>
__device__ __forceinline__ void contact_velocities(
    IslandExec<Team>& exec,
    std::int64_t first,
    std::int64_t count,
    const ContactVelocityOp<DelassusView<T>, T>& op) {
  if (has_long_rows(op.velocities)) {
    exec.for_each_by_warps(count, FromIndex<DelassusVelocityLanesOp<T>>{{op}, 32 * first});
  } else {
    exec.for_each("contact/sweep", count,
                  FromIndex<ContactVelocityOp<DelassusView<T>, T>>{op, first});
  }
}
template <class T>
void contact_velocities(CudaExec& exec,
                        std::int64_t first,
                        std::int64_t count,
                        const ContactVelocityOp<DelassusView<T>, T>& op) {
  if (has_long_rows(op.velocities)) {
    exec.for_each("contact/sweep", 32 * count,
                  FromIndex<DelassusVelocityLanesOp<T>>{{op}, 32 * first});
  } else {
    exec.for_each("contact/sweep", count,
                  FromIndex<ContactVelocityOp<DelassusView<T>, T>>{op, first});
  }
}

}  // namespace tetwarp
