/// @file volume_uniform.hpp
/// Constant regions of the source, in blocks of 8x8x8 samples. Positions in them need no
/// interpolation.
#pragma once
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/face_sign.hpp"
#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {

constexpr int block_shift = 3;    ///< blocks of 8 samples along an axis
constexpr int longest_reach = 5;  ///< edge of the largest constant cube that is searched [block]

/// Constant cubes of blocks of the source.
struct UniformMap {
  /// Per block: edge [block] of a cube of blocks, from this one towards higher i, j and k, in which
  /// the source is constant; 0 if it is not constant in the block, or can_fill() is false for its
  /// value. Parts of the cube beyond the end of the source are ignored. Size 0: unknown.
  View<const std::uint8_t> reach;
  int blocks[3];

  TETWARP_HD std::int64_t block_count() const {
    return std::int64_t{blocks[0]} * blocks[1] * blocks[2];
  }
  TETWARP_HD std::int64_t block_index(int bi, int bj, int bk) const {
    return (std::int64_t{bk} * blocks[1] + bj) * blocks[0] + bi;
  }
  /// The inverse of block_index(): sets bi, bj, bk.
  TETWARP_HD void set_position(std::int64_t block, int* at) const {
    const std::int64_t line = block / blocks[0], layer = line / blocks[1];
    at[0] = static_cast<int>(block - line * blocks[0]);
    at[1] = static_cast<int>(line - layer * blocks[1]);
    at[2] = static_cast<int>(layer);
  }
};

/// A map with the blocks of a source and an empty `reach`.
template <class T>
TETWARP_HD UniformMap make_uniform_map(const SourceView<T>& source) {
  UniformMap map = {};
  for (int axis = 0; axis < 3; ++axis) {
    map.blocks[axis] = ((source.dims[axis] - 1) >> block_shift) + 1;
  }
  return map;
}

/// Number of voxel (i, j, k) among the voxels of the source.
template <class T>
TETWARP_HD std::int64_t voxel_of(const SourceView<T>& source, int i, int j, int k) {
  return (std::int64_t{k} * source.dims[1] + j) * source.dims[0] + i;
}

/// Whether interpolation between samples that equal `value` gives `value` bit for bit. False for
/// NaN, for infinities, whose difference is NaN, and for -0.0, which becomes 0.0.
template <class T>
TETWARP_HD bool can_fill(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    return value - value == T(0) && !(value == T(0) && copysign(T(1), value) < T(0));
  } else {
    return true;
  }
}

/// Whether arrays have equal bits: 0.0 differs from -0.0, and a NaN equals itself.
template <class T>
TETWARP_HD bool has_bits_of(const T* a, const T* b, int count) {
  if constexpr (std::is_floating_point_v<T>) {
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    Bits difference = 0;
    for (int c = 0; c < count; ++c) {
      Bits bits_a, bits_b;
      memcpy(&bits_a, a + c, sizeof(T));
      memcpy(&bits_b, b + c, sizeof(T));
      difference |= bits_a ^ bits_b;
    }
    return difference == 0;
  } else {
    bool equal = true;
    for (int c = 0; c < count; ++c) equal = equal && a[c] == b[c];
    return equal;
  }
}

/// Sets a mark to 1; several threads may set the same mark.
TETWARP_HD void set_mark(std::uint8_t* mark) {
#if defined(__CUDA_ARCH__)
  *mark = 1;
#else
  __atomic_store_n(mark, std::uint8_t{1}, __ATOMIC_RELAXED);
#endif
}

/// One index = one tetrahedron; any order. Marks the blocks that its voxels may sample, and their
/// neighbors.
struct BlockNeedOp {
  View<const std::int32_t> tets;
  View<const Node> rest;
  UniformMap map;
  int origin[3];  ///< index in the source of the first sample
  View<std::uint8_t> needed;

  TETWARP_HD void operator()(std::int64_t t) const {
    const TetNodes tet = tet_nodes(rest, tets.data + 4 * t);
    int first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
      std::int64_t low = tet.x[0][axis], high = low;
      for (int a = 1; a < 4; ++a) {
        low = min_of(low, tet.x[a][axis]);
        high = max_of(high, tet.x[a][axis]);
      }
      low -= origin[axis] * quanta_per_voxel;
      high -= origin[axis] * quanta_per_voxel;
      const std::int64_t end = map.blocks[axis] - 1;
      constexpr int shift = quantum_bits + block_shift;
      first[axis] = static_cast<int>(min_of(max_of((low >> shift) - 1, std::int64_t{0}), end + 1));
      last[axis] = static_cast<int>(min_of(max_of((high >> shift) + 1, std::int64_t{-1}), end));
    }
    for (int bk = first[2]; bk <= last[2]; ++bk) {
      for (int bj = first[1]; bj <= last[1]; ++bj) {
        for (int bi = first[0]; bi <= last[0]; ++bi) {
          set_mark(&needed[map.block_index(bi, bj, bk)]);
        }
      }
    }
  }
};

/// One index = one block; any order. Sets reach to 1 for marked blocks in which the source is
/// constant, to 0 for others.
template <class T>
struct BlockUniformOp {
  static constexpr int resident_blocks = 4;  ///< leaves 64 registers per thread: no spills
  SourceView<T> source;
  UniformMap map;
  View<std::uint8_t> reach;

  TETWARP_HD void operator()(std::int64_t block) const {
    if (reach[block] != 0) reach[block] = is_uniform(block);
  }

  TETWARP_HD bool is_uniform(std::int64_t block) const {
    int begin[3], end[3];
    map.set_position(block, begin);
    for (int axis = 0; axis < 3; ++axis) {
      begin[axis] <<= block_shift;
      end[axis] = min_of(begin[axis] + (1 << block_shift), source.dims[axis]);
    }
    const T* first =
        source.data + voxel_of(source, begin[0], begin[1], begin[2]) * source.components;
    for (int c = 0; c < source.components; ++c) {
      if (!can_fill(first[c])) return false;
    }
    for (int k = begin[2]; k < end[2]; ++k) {
      for (int j = begin[1]; j < end[1]; ++j) {
        // A row is constant if its first voxel equals `first`, and each other one its predecessor.
        const T* row = source.data + voxel_of(source, begin[0], j, k) * source.components;
        const int rest = (end[0] - begin[0] - 1) * source.components;
        if (!has_bits_of(row, first, source.components) ||
            !has_bits_of(row + source.components, row, rest)) {
          return false;
        }
      }
    }
    return true;
  }
};

/// One index = one block; any order. Sets reach to n + 1 if the block and its seven neighbors
/// towards higher i, j and k have reach n and the same value.
template <class T>
struct BlockReachOp {
  static constexpr int resident_blocks = 4;  ///< leaves 64 registers per thread: no spills
  SourceView<T> source;
  UniformMap map;
  int n;
  View<const std::uint8_t> before;
  View<std::uint8_t> reach;
  View<std::int64_t> extended_count;

  TETWARP_HD void operator()(std::int64_t block) const {
    reach[block] = before[block];
    if (before[block] < n || !can_extend(block)) return;
    reach[block] = static_cast<std::uint8_t>(n + 1);
    if (n == 1) atomic_add(&extended_count[0], 1);
  }

  TETWARP_HD bool can_extend(std::int64_t block) const {
    int at[3];
    map.set_position(block, at);
    const T* mine = samples_of(at[0], at[1], at[2]);
    for (int bk = at[2]; bk <= min_of(at[2] + 1, map.blocks[2] - 1); ++bk) {
      for (int bj = at[1]; bj <= min_of(at[1] + 1, map.blocks[1] - 1); ++bj) {
        for (int bi = at[0]; bi <= min_of(at[0] + 1, map.blocks[0] - 1); ++bi) {
          if (before[map.block_index(bi, bj, bk)] < n) return false;
          if (!has_bits_of(samples_of(bi, bj, bk), mine, source.components)) return false;
        }
      }
    }
    return true;
  }

  TETWARP_HD const T* samples_of(int bi, int bj, int bk) const {
    return source.data + voxel_of(source, bi << block_shift, bj << block_shift, bk << block_shift) *
                             source.components;
  }
};

/// Finds constant regions of the source where the mesh may sample it.
///
/// @param exec        where to run
/// @param source      the samples
/// @param tets        node indices, shape [4 * tet_count]
/// @param rest        nodes in the source's index space [quantum], shape [node_count]
/// @param reach       out, see UniformMap, one per block
/// @param scratch     one per block
/// @param extended_count  blocks of reach 2 or more are added to it, shape [1]; with none of them
///                        hardly any cell can be filled
///
/// Determinism: same bits on every back end. Cost: one read of the uniform part of the source, a
/// row of each other block.
/// Source: ours.
template <class Exec, class T>
void volume_uniform(Exec& exec,
                    const SourceView<T>& source,
                    View<const std::int32_t> tets,
                    View<const Node> rest,
                    View<std::uint8_t> reach,
                    View<std::uint8_t> scratch,
                    View<std::int64_t> extended_count) {
  const UniformMap map = make_uniform_map(source);
  exec.zero("warp/setup", reach);
  exec.for_each(
      "warp/setup", tets.size / 4,
      BlockNeedOp{tets, rest, map, {source.origin[0], source.origin[1], source.origin[2]}, reach});
  exec.for_each("warp/setup", reach.size, BlockUniformOp<T>{source, map, reach});
  View<std::uint8_t> from = reach, to = scratch;
  for (int n = 1; n < longest_reach; ++n) {  // an even number of passes: ends in `reach`
    exec.for_each("warp/setup", reach.size,
                  BlockReachOp<T>{source, map, n, from, to, extended_count});
    const View<std::uint8_t> last = from;
    from = to;
    to = last;
  }
}

}  // namespace tetwarp
