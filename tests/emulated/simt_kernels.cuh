/// @file simt_kernels.cuh
/// Small kernels for the tests of the emulation: correct ones, and ones with one error each.
#pragma once
#include "kernels/exec/launch.hpp"

namespace tetwarp {

constexpr unsigned all_lanes = 0xffffffffu;

/// Sums by warp shuffles, shared partial sums and one atomic per block. Without its barrier, the
/// first warp may read partial sums that others have yet to write.
template <bool has_barrier>
__global__ void __launch_bounds__(128) sum_kernel(const int* values, int count, int* sum) {
  __shared__ int partial[4];
  const unsigned lane = threadIdx.x % 32, warp = threadIdx.x / 32;
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  int value = i < count ? values[i] : 0;
  for (unsigned delta = 16; delta > 0; delta /= 2) {
    value += __shfl_down_sync(all_lanes, value, delta);
  }
  if (lane == 0) partial[warp] = value;
  if (has_barrier) __syncthreads();
  if (threadIdx.x == 0) atomicAdd(sum, partial[0] + partial[1] + partial[2] + partial[3]);
}

__device__ __forceinline__ int clamped(int i, int count) {
  return i < 0 ? 0 : i < count ? i : count - 1;
}

/// Sum of each voxel's four neighbors in a clamped image, from a shared tile with a halo.
__global__ void __launch_bounds__(128) stencil_kernel(const int* in, int* out, int nx, int ny) {
  __shared__ int tile[10][18];
  const int tile_x = static_cast<int>(blockIdx.x) * 16 - 1;
  const int tile_y = static_cast<int>(blockIdx.y) * 8 - 1;
  for (int t = static_cast<int>(threadIdx.y * 16 + threadIdx.x); t < 180; t += 128) {
    const int x = clamped(tile_x + t % 18, nx);
    const int y = clamped(tile_y + t / 18, ny);
    tile[t / 18][t % 18] = in[y * nx + x];
  }
  __syncthreads();
  const unsigned tx = threadIdx.x + 1, ty = threadIdx.y + 1;
  const int x = tile_x + static_cast<int>(tx), y = tile_y + static_cast<int>(ty);
  if (x >= nx || y >= ny) return;
  out[y * nx + x] = tile[ty][tx - 1] + tile[ty][tx + 1] + tile[ty - 1][tx] + tile[ty + 1][tx];
}

/// Keeps odd values in order, one block for all of them: ballots and a scan in dynamic memory.
__global__ void __launch_bounds__(96)
    compact_kernel(const int* in, int count, int* out, int* kept) {
  int* const warp_count = dynamic_shared<int>();
  const unsigned lane = threadIdx.x % 32, warp = threadIdx.x / 32;
  int base = 0;
  for (int first = 0; first < count; first += 96) {
    const int i = first + static_cast<int>(threadIdx.x);
    const bool keep = i < count && in[i] % 2 != 0;
    const unsigned votes = __ballot_sync(all_lanes, keep);
    if (lane == 0) warp_count[warp] = __popc(votes);
    __syncthreads();
    int rank = __popc(votes & ((1u << lane) - 1));
    for (unsigned w = 0; w < warp; ++w) rank += warp_count[w];
    if (keep) out[base + rank] = in[i];
    for (unsigned w = 0; w < 3; ++w) base += warp_count[w];
    __syncthreads();
  }
  if (threadIdx.x == 0) *kept = base;
}

/// Results of each shuffle per lane, in segments of eight.
__global__ void shuffle_kernel(int* broadcast, int* up, int* down, int* crossed) {
  const int lane = static_cast<int>(threadIdx.x);
  broadcast[lane] = __shfl_sync(all_lanes, lane, 3, 8);
  up[lane] = __shfl_up_sync(all_lanes, lane, 2, 8);
  down[lane] = __shfl_down_sync(all_lanes, lane, 2, 8);
  crossed[lane] = __shfl_xor_sync(all_lanes, lane, 5, 8);
}

/// Half-warps that exchange a different number of times before the common barrier.
__global__ void half_warp_kernel(int* out) {
  const int lane = static_cast<int>(threadIdx.x);
  int value = lane;
  if (lane < 16) {
    for (int i = 0; i < 3; ++i) value = __shfl_xor_sync(0x0000ffffu, value, 1);
  }
  out[lane] = __shfl_xor_sync(all_lanes, value, 16);
}

__global__ void extremes_kernel(const int* values, int* low, int* high) {
  atomicMin(low, values[threadIdx.x]);
  atomicMax(high, values[threadIdx.x]);
}

/// Each lane passes a value to its left neighbor through shared memory.
template <bool has_barrier>
__global__ void neighbor_kernel(unsigned* out) {
  __shared__ unsigned values[32];
  values[threadIdx.x] = 100;
  __syncwarp();
  values[threadIdx.x] = threadIdx.x;
  if (has_barrier) __syncwarp();
  out[threadIdx.x] = values[(threadIdx.x + 1) % 32];
}

/// Each lane sums a value with that of its right neighbor, then overwrites it.
template <bool has_barrier>
__global__ void overwrite_kernel(int* out) {
  __shared__ int values[32];
  const int lane = static_cast<int>(threadIdx.x);
  values[lane] = lane;
  __syncwarp();
  const int both = values[lane] + values[(lane + 1) % 32];
  const int last = __shfl_sync(all_lanes, both, 31);
  if (has_barrier) __syncwarp();
  values[lane] = last;
  out[lane] = values[lane] + both;
}

__global__ void early_exit_kernel() {
  if (threadIdx.x >= 40) return;
  __syncthreads();
}

__global__ void two_barriers_kernel() {
  if (threadIdx.x % 2 == 0) {  // NOLINT(bugprone-branch-clone): the point of this kernel
    __syncthreads();
  } else {
    __syncthreads();
  }
}

__global__ void outside_mask_kernel() {
  __syncwarp(0x0000ffffu);
}

__global__ void missing_lane_kernel() {
  if (threadIdx.x != 7) __syncwarp();
}

__global__ void absent_source_kernel(int* out) {
  *out = __shfl_sync(0x0000000fu, 1, 9);
}

__global__ void overrun_kernel(int* out) {
  __shared__ int values[32];
  values[threadIdx.x + 1] = 1;
  __syncthreads();
  out[threadIdx.x] = values[threadIdx.x];
}

}  // namespace tetwarp
