/// @file simt.hpp
/// Runs unchanged CUDA kernels on the CPU, to test them without a GPU.
///
/// Defines for a C++ compiler the CUDA names that kernels here use: indices, shared memory,
/// barriers, shuffles, votes and integer atomics. Detects results that depend
/// on the order of threads, barriers that not all threads reach, warp operations that miss a lane
/// and, with the address sanitizer, accesses out of bounds, also in shared memory. With the thread
/// sanitizer it detects all races of a run: accesses that no barrier orders, whether results depend
/// on them or not. Kernels must not spin on other threads.
#pragma once
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include "tests/emulator/block.hpp"

// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming): CUDA's own names
#define __host__
#define __device__
#define __global__ [[maybe_unused]] static  // the sanitizer guards no statics of inline functions
#define __forceinline__ inline
#define __noinline__
#define __launch_bounds__(...)
#if defined(__SANITIZE_ADDRESS__)
#define __shared__ static  // the sanitizer guards no thread-local storage; blocks run one by one
#else
#define __shared__ static thread_local  // an OS thread runs one block at a time
#endif

using cudaStream_t = void*;
/// The default stream, which null also means.
inline const cudaStream_t cudaStreamLegacy = reinterpret_cast<cudaStream_t>(1);

struct uint3 {
  unsigned x = 0, y = 0, z = 0;
};

struct dim3 {
  unsigned x = 1, y = 1, z = 1;
  constexpr dim3(unsigned nx = 1, unsigned ny = 1, unsigned nz = 1) : x(nx), y(ny), z(nz) {}
};

constinit inline thread_local uint3 threadIdx{};
constinit inline thread_local uint3 blockIdx{};
constinit inline thread_local dim3 blockDim{};
constinit inline thread_local dim3 gridDim{};

inline void __syncthreads(int line = __builtin_LINE()) {
  tetwarp::simt::Block::current().wait_at_barrier(line);
}

inline unsigned __ballot_sync(unsigned mask, int predicate, int line = __builtin_LINE()) {
  return tetwarp::simt::Block::current().ballot(mask, predicate != 0, line);
}

/// Of the exchanges of a warp only this one orders accesses to memory.
inline void __syncwarp(unsigned mask = ~0u, int line = __builtin_LINE()) {
  tetwarp::simt::Block::current().ballot(mask, false, line, true);
}

inline int __any_sync(unsigned mask, int predicate, int line = __builtin_LINE()) {
  return __ballot_sync(mask, predicate, line) != 0;
}

inline int __all_sync(unsigned mask, int predicate, int line = __builtin_LINE()) {
  return __ballot_sync(mask, !predicate, line) == 0;
}

template <class T>
T __shfl_sync(unsigned mask, T value, int source, int width = 32, int line = __builtin_LINE()) {
  auto& block = tetwarp::simt::Block::current();
  const unsigned within = static_cast<unsigned>(width) - 1;
  const unsigned lane = (block.lane() & ~within) | (static_cast<unsigned>(source) & within);
  return block.shuffle(mask, value, lane, line);
}

template <class T>
T __shfl_up_sync(
    unsigned mask, T value, unsigned delta, int width = 32, int line = __builtin_LINE()) {
  auto& block = tetwarp::simt::Block::current();
  const unsigned within = block.lane() & (static_cast<unsigned>(width) - 1);
  return block.shuffle(mask, value, block.lane() - (delta <= within ? delta : 0), line);
}

template <class T>
T __shfl_down_sync(
    unsigned mask, T value, unsigned delta, int width = 32, int line = __builtin_LINE()) {
  auto& block = tetwarp::simt::Block::current();
  const unsigned left = ~block.lane() & (static_cast<unsigned>(width) - 1);
  return block.shuffle(mask, value, block.lane() + (delta <= left ? delta : 0), line);
}

template <class T>
T __shfl_xor_sync(unsigned mask, T value, int bits, int width = 32, int line = __builtin_LINE()) {
  auto& block = tetwarp::simt::Block::current();
  const unsigned last = block.lane() | (static_cast<unsigned>(width) - 1);
  const unsigned lane = block.lane() ^ static_cast<unsigned>(bits);
  return block.shuffle(mask, value, lane <= last ? lane : block.lane(), line);
}

inline int __popc(unsigned bits) {
  return __builtin_popcount(bits);
}

/// Lowest set bit, counted from 1; 0 when none is set.
inline int __ffs(int bits) {
  return __builtin_ffs(bits);
}

inline void __threadfence() {
  __atomic_thread_fence(__ATOMIC_SEQ_CST);
}

template <std::integral T>
T atomicAdd(T* address, std::type_identity_t<T> value) {
  return __atomic_fetch_add(address, value, __ATOMIC_RELAXED);
}

template <std::integral T>
T atomicAnd(T* address, std::type_identity_t<T> value) {
  return __atomic_fetch_and(address, value, __ATOMIC_RELAXED);
}

template <std::integral T>
T atomicMin(T* address, std::type_identity_t<T> value) {
  T old = __atomic_load_n(address, __ATOMIC_RELAXED);
  while (value < old && !__atomic_compare_exchange_n(address, &old, value, true, __ATOMIC_RELAXED,
                                                     __ATOMIC_RELAXED)) {
  }
  return old;
}

template <std::integral T>
T atomicMax(T* address, std::type_identity_t<T> value) {
  T old = __atomic_load_n(address, __ATOMIC_RELAXED);
  while (old < value && !__atomic_compare_exchange_n(address, &old, value, true, __ATOMIC_RELAXED,
                                                     __ATOMIC_RELAXED)) {
  }
  return old;
}
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)

namespace tetwarp::simt {

/// The schedule of later launches; callers assign to it.
inline Schedule& schedule() {
  static Schedule current;
  return current;
}

/// Calls `check(schedule)` with launches running forward, in reverse, and shuffled by three seeds.
template <class Check>
void for_each_schedule(Check check) {
  for (const Schedule next :
       {Schedule{ThreadOrder::forward}, Schedule{ThreadOrder::reverse},
        Schedule{ThreadOrder::shuffled, 1}, Schedule{ThreadOrder::shuffled, 2},
        Schedule{ThreadOrder::shuffled, 3}}) {
    schedule() = next;
    check(next);
  }
  schedule() = Schedule{};
}

/// Shared memory that cudaFuncSetAttribute() allowed to kernels [bytes].
inline std::map<const void*, std::size_t>& shared_limits() {
  static std::map<const void*, std::size_t> limits;
  return limits;
}
inline std::size_t shared_limit(const void* kernel) {
  const auto known = shared_limits().find(kernel);
  return known == shared_limits().end() ? std::size_t{48} * 1024 : known->second;
}

/// @param most_shared  shared memory that the kernel may have
/// @throws Fault if a launch exceeds limits that hold on every GPU by default
inline void check_launch(dim3 grid,
                         dim3 block,
                         std::size_t shared_bytes,
                         std::size_t most_shared = std::size_t{48} * 1024) {
  const std::uint64_t threads = std::uint64_t{block.x} * block.y * block.z;
  if (threads == 0 || threads > 1024 || block.z > 64) throw Fault("block size");
  if (grid.x == 0 || grid.y == 0 || grid.z == 0 || grid.x > 0x7fffffffu || grid.y > 65535 ||
      grid.z > 65535) {
    throw Fault("grid size");
  }
  if (shared_bytes > most_shared) throw Fault("shared memory");
}

/// Grids of fewer blocks run on one OS thread: waking other threads would take longer.
constexpr std::int64_t fewest_parallel_blocks = 64;

/// Runs a kernel to its end: blocks in parallel on OS threads, unless it is observed, threads of a
/// block by schedule().
/// @throws Fault if a block has one
template <class Kernel, class... Args>
void launch(Kernel kernel, dim3 grid, dim3 block, std::size_t shared_bytes, const Args&... args) {
  check_launch(grid, block, shared_bytes, shared_limit(reinterpret_cast<const void*>(kernel)));
  const std::int64_t slice = std::int64_t{grid.x} * grid.y;
  const std::int64_t block_count = slice * grid.z;
  LaunchObserver* const observer = LaunchObserver::current();
  const bool is_parallel = !has_address_sanitizer && !has_thread_sanitizer && observer == nullptr &&
                           block_count >= fewest_parallel_blocks;
  if (observer != nullptr) {
    observer->launch_begins(typeid(kernel).name(), block_count,
                            std::int64_t{block.x} * block.y * block.z);
  }
  std::exception_ptr fault;
#pragma omp parallel for schedule(dynamic) if (is_parallel)
  for (std::int64_t b = 0; b < block_count; ++b) {
    if (observer != nullptr && !observer->runs(b)) continue;
    blockIdx = {static_cast<unsigned>(b % grid.x), static_cast<unsigned>(b % slice / grid.x),
                static_cast<unsigned>(b / slice)};
    blockDim = block;
    gridDim = grid;
    const auto set_thread = [&block](unsigned t) {
      threadIdx = block.y * block.z == 1
                      ? uint3{t, 0, 0}
                      : uint3{t % block.x, t / block.x % block.y, t / (block.x * block.y)};
    };
    Schedule own = schedule();
    own.seed += static_cast<unsigned>(b);  // the same for any number of OS threads
    try {
      Block::current().run(
          block.x * block.y * block.z, shared_bytes, own, [&] { kernel(args...); }, set_thread);
      if (observer != nullptr) observer->block_ends();
    } catch (...) {
#pragma omp critical
      fault = std::current_exception();
    }
  }
  if (fault) std::rethrow_exception(fault);
  if (observer != nullptr) observer->launch_ends();
}

/// Runs a kernel whose blocks are all resident and may wait for each other, on one OS thread, each
/// block up to its next barrier of the grid. Such a kernel has dynamic shared memory only.
/// @throws Fault if a block has one, or returns while others wait for it
template <class Kernel, class... Args>
void launch_cooperative(
    Kernel kernel, dim3 grid, dim3 block, std::size_t shared_bytes, const Args&... args) {
  check_launch(grid, block, shared_bytes, shared_limit(reinterpret_cast<const void*>(kernel)));
  if (grid.y != 1 || grid.z != 1 || block.y != 1 || block.z != 1) throw Fault("grid of blocks");
  const std::function<void()> run = [&] { kernel(args...); };
  static thread_local std::vector<std::unique_ptr<Block>> blocks;
  while (blocks.size() < grid.x) blocks.push_back(std::make_unique<Block>());
  std::vector<unsigned> order(grid.x);
  std::iota(order.begin(), order.end(), 0u);
  if (schedule().order == ThreadOrder::reverse) std::reverse(order.begin(), order.end());
  blockDim = block;
  gridDim = grid;
  for (const unsigned b : order) {
    Schedule own = schedule();
    own.seed += b;
    blocks[b]->start(block.x, shared_bytes, own, run);
  }
  struct Chosen {
    ~Chosen() { Block::choose(nullptr); }
  } const chosen;
  const IgnoredAccesses of_emulation;
  for (unsigned waiting = grid.x; waiting > 0;) {
    waiting = 0;
    for (const unsigned b : order) {
      Block::choose(blocks[b].get());
      blockIdx = {b, 0, 0};
      blocks[b]->go_on([](unsigned t) { threadIdx = {t, 0, 0}; });
      waiting += blocks[b]->is_done() ? 0 : 1;
    }
    if (waiting != 0 && waiting != grid.x) throw Fault("barrier of the grid not reached by all");
    for (const unsigned b : order) {
      if (waiting > 0) blocks[b]->release_order(&order);
    }
    for (const unsigned b : order) {
      if (waiting > 0) blocks[b]->acquire_order(&order);
      if (waiting > 0) blocks[b]->release_grid();
    }
  }
}

}  // namespace tetwarp::simt
