/// @file contact_residual.cuh
/// Stage "residual" of the contact solver, mapped by hand: sums over contacts by a tree that
/// depends on nothing but their number.
///
/// 128 threads; each adds up every 128th contact of its run, then halves of the block are folded.
/// No atomics.
#pragma once
#include "kernels/contact_residual.hpp"
#include "kernels/contact_sweep.hpp"
#include "kernels/launch.hpp"

namespace tetwarp {

constexpr int sum_threads = 128;
constexpr int sum_run = 1024;  ///< contacts per block of contact_sums_kernel

/// One index = one contact: its velocity (stored), then its share in the residual.
template <class Velocities, class T>
struct ContactTermBody {
  ContactVelocityBody<Velocities, T> velocity;
  ContactResidualBody<T> residual;

  TETWARP_HD ContactSums operator()(std::int64_t c) const {
    velocity(c);
    return residual(c);
  }
};

/// The term of a sweep's contacts, which reads what the sweep writes.
/// @param velocity  scratch, [3 slots]
template <class T>
TETWARP_HD ContactTermBody<DelassusView<T>, T> term_of(const DelassusSweepBody<T>& sweep,
                                                       View<const T> free_velocity,
                                                       View<T> velocity) {
  return {{sweep.delassus, sweep.impulse.data, velocity},
          {sweep.constants, sweep.switches, sweep.impulse, velocity, free_velocity}};
}
template <class T>
TETWARP_HD ContactTermBody<BodiesView<T>, T> term_of(const BodySweepBody<T>& sweep,
                                                     View<const T> free_velocity,
                                                     View<T> velocity) {
  return {{sweep.bodies, sweep.body_velocity.data, velocity},
          {sweep.constants, sweep.switches, sweep.impulse, velocity, free_velocity}};
}

/// One index = one sum made before.
struct ReadySums {
  View<const ContactSums> sums;

  TETWARP_HD ContactSums operator()(std::int64_t i) const { return sums[i]; }
};

/// tree[0] = sum of term(i) for i in [first, last), seen by the whole block.
/// @param tree  shared, [sum_threads]
template <class Term>
__device__ __forceinline__ void block_sum(std::int64_t first,
                                          std::int64_t last,
                                          const Term& term,
                                          ContactSums* tree) {
  const int thread = static_cast<int>(threadIdx.x);
  ContactSums mine;
  for (std::int64_t i = first + thread; i < last; i += sum_threads) mine += term(i);
  tree[thread] = mine;
  for (int half = sum_threads / 2; half > 0; half /= 2) {
    __syncthreads();
    if (thread < half) tree[thread] += tree[thread + half];
  }
  __syncthreads();
}

/// sums[b] = sum of term over the b-th `run` of [first, last).
/// Blocks: one per run. Threads: sum_threads. Shared: 6 KiB, dynamic. Registers: up to 128.
template <class Term>
__global__ void __launch_bounds__(sum_threads, 4) contact_sums_kernel(
    std::int64_t first, std::int64_t last, std::int64_t run, Term term, View<ContactSums> sums) {
  ContactSums* tree = dynamic_shared<ContactSums>();
  const std::int64_t begin = first + run * static_cast<std::int64_t>(blockIdx.x);
  block_sum(begin, min_of(begin + run, last), term, tree);
  if (threadIdx.x == 0) sums[static_cast<std::int64_t>(blockIdx.x)] = tree[0];
}

/// Sums that the two steps below need room for.
inline std::int64_t sums_needed(std::int64_t contacts) {
  return (contacts + sum_run - 1) / sum_run + 1;
}

/// Residual of contacts [first, last), at least one, into the last of `sums`.
/// @param sums  [sums_needed(last - first)]
/// Determinism: a fixed tree; not the one of the host, so the last bits differ from its sums.
template <class Term>
void contact_sums(cudaStream_t stream,
                  std::int64_t first,
                  std::int64_t last,
                  const Term& term,
                  View<ContactSums> sums) {
  constexpr std::size_t shared_bytes = sum_threads * sizeof(ContactSums);
  const std::int64_t runs = sums.size - 1;
  launch(stream, contact_sums_kernel<Term>, dim3(static_cast<unsigned>(runs)), dim3(sum_threads),
         shared_bytes, first, last, std::int64_t{sum_run}, term, sums);
  launch(stream, contact_sums_kernel<ReadySums>, dim3(1), dim3(sum_threads), shared_bytes,
         std::int64_t{0}, runs, runs, ReadySums{{sums.data, runs}},
         View<ContactSums>{sums.data + runs, 1});
}

}  // namespace tetwarp
