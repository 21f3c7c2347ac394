/// @file contact_sweep.cuh
/// Stage "sweep" of the contact solver, mapped by hand: one block solves one island from its first
/// sweep to its last, measuring included, in a single launch.
///
/// 128 threads share the contacts of a color, a barrier parts the colors. Impulses and velocities
/// of bodies live in shared memory where they fit, else in place. The order of updates is that of
/// contact_sweep(), so are the bits (with contraction off).
#pragma once
#include <algorithm>

#include "kernels/contact_progress.hpp"
#include "kernels/contact_residual.cuh"
#include "kernels/contact_sweep.hpp"
#include "kernels/launch.hpp"

namespace tetwarp {

constexpr int sweep_threads = sum_threads;
constexpr int sweep_blocks = 4;     ///< resident per multiprocessor: leaves 128 registers
constexpr int sweeps_per_look = 8;  ///< measuring costs about one sweep

/// All islands that are solved by one block each.
template <class T, class Body>
struct SweepJob {
  Body body;  ///< on impulses [3 slots] and velocities of bodies [dofs]
  View<const std::int64_t> color_start;
  View<const T> free_velocity;  ///< q, [3 slots]
  View<const SweepIsland> islands;
  SweepLimit limit;
  std::int64_t shared_values;    ///< islands of more numbers are swept in place
  View<T> velocity;              ///< scratch, [3 slots]
  View<T> best;                  ///< out: the best impulses, [3 slots]; in: those at hand
  View<SweepProgress> progress;  ///< out, [islands]
};

/// What the threads of a block tell each other; the island's numbers follow it.
struct SweepShared {
  ContactSums tree[sum_threads];
  SweepProgress progress;
  bool is_best;
};

template <class T>
__device__ __forceinline__ void block_copy(const T* from, T* to, std::int64_t count) {
  for (std::int64_t i = static_cast<std::int64_t>(threadIdx.x); i < count; i += sweep_threads) {
    to[i] = from[i];
  }
}

/// Moves numbers [first, last) to `place` and has `view` find them there under their old indices.
template <class T>
__device__ __forceinline__ void move_values(View<T>& view,
                                            std::int64_t first,
                                            std::int64_t last,
                                            T* place) {
  block_copy(view.data + first, place, last - first);
  view.data = place - first;
}

/// Moves what the sweeps of an island change to `place`.
template <class T>
__device__ __forceinline__ void move_state(const SweepIsland& island,
                                           T* place,
                                           DelassusSweepBody<T>& body) {
  move_values(body.impulse, 3 * island.slot_begin, 3 * island.slot_end, place);
}
template <class T>
__device__ __forceinline__ void move_state(const SweepIsland& island,
                                           T* place,
                                           BodySweepBody<T>& body) {
  move_values(body.impulse, 3 * island.slot_begin, 3 * island.slot_end, place);
  move_values(body.body_velocity, island.dof_begin, island.dof_end,
              place + 3 * island.contact_count());
}

/// Blocks: one per island. Threads: sweep_threads. Shared: one SweepShared, 6.4 KiB, and
/// job.shared_values numbers, dynamic. Registers: up to 128.
template <class T, class Body>
__global__ void __launch_bounds__(sweep_threads, sweep_blocks)
    contact_sweep_kernel(SweepJob<T, Body> job) {
  SweepShared& shared = *dynamic_shared<SweepShared>();
  const std::int64_t thread = static_cast<std::int64_t>(threadIdx.x);
  const SweepIsland island = job.islands[static_cast<std::int64_t>(blockIdx.x)];
  const std::int64_t first_value = 3 * island.slot_begin;
  Body body = job.body;
  if (island.value_count() <= job.shared_values) {
    move_state(island, reinterpret_cast<T*>(&shared + 1), body);
  }
  if (thread == 0) shared.progress = SweepProgress{};
  __syncthreads();
  const auto term = term_of(body, job.free_velocity, job.velocity);

  for (std::int64_t swept = 0;;) {
    block_sum(island.slot_begin, island.slot_end, term, shared.tree);
    if (thread == 0) {
      shared.is_best = shared.progress.take(shared.tree[0], swept, job.limit, island.allowed);
    }
    __syncthreads();
    if (shared.is_best) {
      block_copy(body.impulse.data + first_value, job.best.data + first_value,
                 3 * island.contact_count());
    }
    if (shared.progress.is_done) break;
    const std::int64_t next = min_of(swept + sweeps_per_look, job.limit.max_sweeps);
    __syncthreads();  // everybody has its copy
    for (; swept < next; ++swept) {
      for (std::int64_t k = island.color_begin; k + 1 < island.color_end; ++k) {
        const std::int64_t end = job.color_start[k + 1];
        for (std::int64_t c = job.color_start[k] + thread; c < end; c += sweep_threads) body(c);
        __syncthreads();
      }
    }
  }
  if (thread == 0) job.progress[static_cast<std::int64_t>(blockIdx.x)] = shared.progress;
}

/// Most numbers of an island that the 48 KiB of a block hold.
template <class T>
constexpr std::int64_t shared_capacity =
    static_cast<std::int64_t>((std::size_t{48} * 1024 - sizeof(SweepShared)) / sizeof(T));

/// The room that islands need in shared memory, those left out that do not fit.
/// @param islands  on the host
template <class T>
std::int64_t shared_values_for(View<const SweepIsland> islands) {
  std::int64_t most = 0;
  for (std::int64_t i = 0; i < islands.size; ++i) {
    const std::int64_t count = islands[i].value_count();
    if (count <= shared_capacity<T>) most = std::max(most, count);
  }
  return most;
}

/// Sweeps every island of the job, at least one, to its end.
/// Determinism: islands do not meet, contacts of a color do not meet, sums are fixed trees.
/// Cost: per sweep and contact as contact_sweep(), per sweep and color one barrier.
template <class T, class Body>
void contact_sweep_islands(cudaStream_t stream, const SweepJob<T, Body>& job) {
  launch(stream, contact_sweep_kernel<T, Body>, dim3(static_cast<unsigned>(job.islands.size)),
         dim3(sweep_threads),
         sizeof(SweepShared) + static_cast<std::size_t>(job.shared_values) * sizeof(T), job);
}

}  // namespace tetwarp
