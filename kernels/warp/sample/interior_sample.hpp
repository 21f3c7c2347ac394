/// @file interior_sample.hpp
/// Linear interpolation where every neighbor lies in the source: no clamps, and offsets of 32 bits
/// from a uniform start. Same bits as tap_of() and sample() of volume_sample.hpp.
#pragma once
#include <cstdint>
#include <type_traits>

#include "kernels/base/hd.hpp"
#include "kernels/base/pixel.hpp"
#include "kernels/warp/sample/packed_source.hpp"
#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {

/// The value itself, which a device keeps in a register: the compiler can neither compute it again
/// nor join its computation with what it is used for.
TETWARP_HD std::uint32_t kept(std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  asm volatile("" : "+r"(value));
#endif
  return value;
}

/// The same for other types of 32 bits or less.
template <class T>
requires std::is_arithmetic_v<T> TETWARP_HD T kept(T value) {
#if defined(__CUDA_ARCH__)
  if constexpr (std::is_same_v<T, float>) {
    asm volatile("" : "+f"(value));
  } else {
    value = static_cast<T>(kept(static_cast<std::uint32_t>(value)));
  }
#endif
  return value;
}

/// The same for a pointer to global memory.
template <class T>
TETWARP_HD T* kept(T* pointer) {
#if defined(__CUDA_ARCH__)
  asm volatile("" : "+l"(pointer));
  __builtin_assume(__isGlobal(pointer));
#endif
  return pointer;
}
template <class T>
TETWARP_HD const PackedSample<T>* kept(const PackedSample<T>* pointer) {
  return reinterpret_cast<const PackedSample<T>*>(kept(reinterpret_cast<const T*>(pointer)));
}

/// Bits of the float 1.5 x 2^23, whose last place is one: adding it rounds to an integer.
constexpr std::uint32_t integer_bits = 0x4b400000u;

/// The largest integer not above x, for |x| < 2^22. On a device one addition that rounds down.
/// @param lower  out, that integer
/// @returns integer_bits plus it
TETWARP_HD std::uint32_t floor_bits(float x, float& lower) {
#if defined(__CUDA_ARCH__)
  const std::uint32_t bits = kept(__float_as_uint(__fadd_rd(x, 0x1.8p23f)));
  lower = __uint_as_float(bits) - 0x1.8p23f;
  return bits;
#else
  lower = floor(x);
  return integer_bits + static_cast<std::uint32_t>(static_cast<int>(lower));
#endif
}

/// A position: its lower neighbor, and weights.
struct InteriorTap {
  std::uint32_t bits[3];  ///< integer_bits plus the voxel from which local positions count
  float fraction[3];
};

/// The tap at local position x.
TETWARP_HD InteriorTap interior_tap(const float* x) {
  InteriorTap tap;
  for (int axis = 0; axis < 3; ++axis) {
    float lower;
    tap.bits[axis] = floor_bits(x[axis], lower);
    tap.fraction[axis] = x[axis] - lower;
  }
  return tap;
}

/// A tap that may lie at or beyond the border of the source.
struct RimTap {
  InteriorTap tap;
  bool is_defined;  ///< the source is defined there; else the tap is that of its first voxel
  bool blends[3];   ///< there are two neighbors along the axis
};

/// The tap at local position x, with the fractions of tap_of().
/// @param whole  the map's first voxel, below 2^22
/// @param dims   of the source
TETWARP_HD RimTap rim_tap(const float* whole, const int* dims, const float* x) {
  RimTap rim;
  rim.is_defined = true;
  float last[3];
  for (int axis = 0; axis < 3; ++axis) {
    last[axis] = static_cast<float>(dims[axis] - 1) - whole[axis];
    const float low = -0.5f - whole[axis] - rim_slack, high = last[axis] + 0.5f + rim_slack;
    rim.is_defined = rim.is_defined && x[axis] >= low && x[axis] <= high;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const float first = -whole[axis], lower = floor(x[axis]);
    rim.blends[axis] = rim.is_defined && lower >= first && lower < last[axis];
    rim.tap.fraction[axis] = rim.blends[axis] ? x[axis] - lower : 0.0f;
    const float at = larger_of(smaller_of(lower, last[axis]), first);
    float voxel;
    rim.tap.bits[axis] = floor_bits(rim.is_defined ? at : 0.0f, voxel);
  }
  return rim;
}

/// The eight samples around a tap, [z][y][x].
template <class T>
struct SampleCube {
  T at[2][2][2];
};

/// Offsets between samples of one component, for a source that each voxel reads elsewhere.
struct SourceSteps {
  std::int32_t row;    ///< one voxel along j [sample]
  std::int32_t slice;  ///< one voxel along k
  std::uint32_t bias;  ///< what floor_bits() adds to an offset

  TETWARP_HD explicit SourceSteps(const int* dims)
      : row(dims[0]),
        slice(dims[0] * dims[1]),
        bias(integer_bits *
             (1 + static_cast<std::uint32_t>(row) + static_cast<std::uint32_t>(slice))) {}

  TETWARP_HD std::int32_t offset_of(const InteriorTap& tap) const {
    return static_cast<std::int32_t>(
        tap.bits[2] * static_cast<std::uint32_t>(slice) +
        (tap.bits[1] * static_cast<std::uint32_t>(row) + (tap.bits[0] - bias)));
  }

  /// @param at  the lower neighbor of all eight
  template <class T>
  TETWARP_HD SampleCube<T> cube(const T* at) const {
    SampleCube<T> cube;
    for (int z = 0; z < 2; ++z) {
      for (int y = 0; y < 2; ++y) {
        const T* const line = at + (y * row + z * slice);
        cube.at[z][y][0] = line[0];
        cube.at[z][y][1] = line[1];
      }
    }
    return cube;
  }

  /// The same from a packed source.
  template <class T>
  TETWARP_HD SampleCube<T> cube(const PackedSample<T>* at) const {
    return packed_cube(at, row, slice);
  }

  /// The same, where some axes have one neighbor.
  template <class T>
  TETWARP_HD SampleCube<T> cube(const PackedSample<T>* at, const RimTap& rim) const {
    return packed_cube(at, rim.blends[1] ? row : 0, rim.blends[2] ? slice : 0);
  }
  template <class T>
  TETWARP_HD SampleCube<T> cube(const T* at, const RimTap& rim) const {
    const int step[3] = {rim.blends[0] ? 1 : 0, rim.blends[1] ? row : 0, rim.blends[2] ? slice : 0};
    SampleCube<T> cube;
    for (int z = 0; z < 2; ++z) {
      for (int y = 0; y < 2; ++y) {
        const T* const line = at + (y * step[1] + z * step[2]);
        cube.at[z][y][0] = line[0];
        cube.at[z][y][1] = line[step[0]];
      }
    }
    return cube;
  }

 private:
  /// A weight is zero where an axis has one neighbor, so the other sample does not matter.
  template <class T>
  TETWARP_HD static SampleCube<T> packed_cube(const PackedSample<T>* at,
                                              std::int32_t along_j,
                                              std::int32_t along_k) {
    SampleCube<T> cube;
    for (int z = 0; z < 2; ++z) {
      for (int y = 0; y < 2; y += packed_rows<T>) {
        const PackedSample<T> sample = at[y * along_j + z * along_k];
        for (int r = 0; r < packed_rows<T>; ++r) {
          for (int x = 0; x < 2; ++x) cube.at[z][y + r][x] = sample.at[r][x];
        }
      }
    }
    return cube;
  }
};

/// Samples of one component from voxel `whole` of a source on, at offsets of 32 bits.
template <class T>
struct InteriorSource {
  const T* rows[2][2];  ///< voxel `whole`, one along j, one along k, one along both
  std::uint32_t row;    ///< offset of one voxel along j [sample]
  std::uint32_t slice;  ///< along k
  std::uint32_t bias;   ///< what floor_bits() adds to an offset

  /// @param lane  differs between threads. The rows begin so many samples later and offsets are as
  ///              much smaller: a device adds an offset to an address of the thread by one
  ///              instruction, to one that all threads share by two.
  TETWARP_HD InteriorSource(const T* from, const int* dims, int lane)
      : row(static_cast<std::uint32_t>(dims[0])),
        slice(static_cast<std::uint32_t>(dims[0]) * static_cast<std::uint32_t>(dims[1])),
        bias(integer_bits * (1 + row + slice) + static_cast<std::uint32_t>(lane)) {
    for (int z = 0; z < 2; ++z) {
      for (int y = 0; y < 2; ++y) {
        rows[z][y] =
            kept(from + lane + (std::int64_t{y} * dims[0] + std::int64_t{z} * dims[0] * dims[1]));
      }
    }
  }

  /// From the first sample of a row [sample].
  TETWARP_HD std::int32_t offset_of(const InteriorTap& tap) const {
    return static_cast<std::int32_t>(tap.bits[2] * slice +
                                     (tap.bits[1] * row + (tap.bits[0] - bias)));
  }

  TETWARP_HD SampleCube<T> cube(const InteriorTap& tap) const {
    const std::int32_t offset = offset_of(tap);
    SampleCube<T> cube;
    for (int z = 0; z < 2; ++z) {
      for (int y = 0; y < 2; ++y) {
        const T* const at = rows[z][y] + offset;
        cube.at[z][y][0] = at[0];
        cube.at[z][y][1] = at[1];
      }
    }
    return cube;
  }
};

/// Interpolated along y, then z, then x: the order of linear_value().
template <class T>
TETWARP_HD T interior_value(const SampleCube<T>& cube, const InteriorTap& tap) {
  float column[2];
  for (int x = 0; x < 2; ++x) {
    float slice[2];
    for (int z = 0; z < 2; ++z) {
      slice[z] = lerp_of(tap.fraction[1], static_cast<float>(cube.at[z][0][x]),
                         static_cast<float>(cube.at[z][1][x]));
    }
    column[x] = lerp_of(tap.fraction[2], slice[0], slice[1]);
  }
  return rounded_to<T>(lerp_of(tap.fraction[0], column[0], column[1]));
}

}  // namespace tetwarp
