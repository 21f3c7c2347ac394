/// @file avx512_sample.hpp
/// Trilinear samples of float32 at 16 positions, in AVX-512 F, DQ and VL instructions.
#pragma once
#include <immintrin.h>

#include <array>

namespace tetwarp::bench {

/// Samples a volume, positions clamped to it. At least two voxels per axis.
class Sampler16 {
 public:
  Sampler16(const float* samples, const std::array<int, 3>& dims)
      : samples_(samples), row_(dims[0]), slice_(dims[0] * dims[1]), dims_(dims) {}

  /// Values at x [voxel]; lanes outside the mask read nothing.
  __m512 at(const __m512 (&x)[3], __mmask16 mask) const {
    __m512 fraction[3];
    __m512i offset = _mm512_setzero_si512();
    for (std::size_t axis = 3; axis-- > 0;) {
      const int dims = dims_[axis];
      const __m512 last = _mm512_set1_ps(static_cast<float>(dims - 1));
      const __m512 inside = _mm512_min_ps(_mm512_max_ps(x[axis], _mm512_setzero_ps()), last);
      const __m512i low =
          _mm512_min_epi32(_mm512_cvttps_epi32(inside), _mm512_set1_epi32(dims - 2));
      fraction[axis] = _mm512_sub_ps(inside, _mm512_cvtepi32_ps(low));
      offset = _mm512_add_epi32(_mm512_mullo_epi32(offset, _mm512_set1_epi32(dims)), low);
    }
    // The low and the high half of the lanes; each lane becomes a pair of neighbors along x.
    const __m512i low_pairs = _mm512_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7);
    const __m512i high_pairs = _mm512_add_epi32(low_pairs, _mm512_set1_epi32(8));
    const __m512 low =
        pairs_at(_mm512_castsi512_si256(offset), _mm512_permutexvar_ps(low_pairs, fraction[1]),
                 _mm512_permutexvar_ps(low_pairs, fraction[2]), static_cast<__mmask8>(mask));
    const __m512 high = pairs_at(
        _mm512_extracti64x4_epi64(offset, 1), _mm512_permutexvar_ps(high_pairs, fraction[1]),
        _mm512_permutexvar_ps(high_pairs, fraction[2]), static_cast<__mmask8>(mask >> 8));
    const __m512i even =
        _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    const __m512i odd = _mm512_add_epi32(even, _mm512_set1_epi32(1));
    return lerp(fraction[0], _mm512_permutex2var_ps(low, even, high),
                _mm512_permutex2var_ps(low, odd, high));
  }

 private:
  static __m512 lerp(__m512 fraction, __m512 a, __m512 b) {
    return _mm512_fmadd_ps(fraction, _mm512_sub_ps(b, a), a);
  }

  /// Gathers of 64 bits fetch both neighbors along x; they are blended along y and z.
  __m512 pairs_at(__m256i offset, __m512 fraction_y, __m512 fraction_z, __mmask8 mask) const {
    const auto gather = [&](const float* base) {
      return _mm512_castpd_ps(
          _mm512_mask_i32gather_pd(_mm512_setzero_pd(), mask, offset, base, sizeof(float)));
    };
    const __m512 near = lerp(fraction_y, gather(samples_), gather(samples_ + row_));
    const __m512 far =
        lerp(fraction_y, gather(samples_ + slice_), gather(samples_ + slice_ + row_));
    return lerp(fraction_z, near, far);
  }

  const float* samples_;
  int row_, slice_;
  std::array<int, 3> dims_;
};

/// Samples voxels [begin, end) of a row: voxel i lies at base + i step in the source.
inline void sample_row16(const Sampler16& sampler,
                         const float* base,
                         const float* step,
                         int begin,
                         int end,
                         float* row) {
  const __m512 lane = _mm512_setr_ps(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  for (int i = begin; i < end; i += 16) {
    const auto mask = static_cast<__mmask16>(end - i >= 16 ? 0xffff : (1 << (end - i)) - 1);
    const __m512 place = _mm512_add_ps(_mm512_set1_ps(static_cast<float>(i)), lane);
    __m512 x[3];
    for (int axis = 0; axis < 3; ++axis) {
      x[axis] = _mm512_fmadd_ps(place, _mm512_set1_ps(step[axis]), _mm512_set1_ps(base[axis]));
    }
    _mm512_mask_storeu_ps(row + i, mask, sampler.at(x, mask));
  }
}

}  // namespace tetwarp::bench
