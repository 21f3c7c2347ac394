/// @file row_reorient-inl.hpp
/// Reorients the values of successive voxels by one matrix, bit-equal to reorient(). Included once
/// per vector instruction set.
#if defined(TETWARP_ROW_REORIENT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_REORIENT_INL
#undef TETWARP_ROW_REORIENT_INL
#else
#define TETWARP_ROW_REORIENT_INL
#endif

#include <hwy/highway.h>

#include "host/warp/cpu/rows/row_wide_values-inl.hpp"
#include "kernels/warp/voxel_transform.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using WideVec = hn::Vec<WideTag>;  ///< one number of several voxels

/// Sum over n of a[n] b[n].
HWY_INLINE WideVec dot3(const double* a, const WideVec* b) {
  const WideTag d;
  const auto first = hn::Mul(hn::Set(d, a[0]), b[0]), second = hn::Mul(hn::Set(d, a[1]), b[1]);
  return hn::Add(hn::Add(first, second), hn::Mul(hn::Set(d, a[2]), b[2]));
}

/// m v.
HWY_INLINE void turn_vectors(const Matrix3& m, WideVec* v) {
  const WideVec before[3] = {v[0], v[1], v[2]};
  for (int row = 0; row < 3; ++row) v[row] = dot3(m.at[row], before);
}

/// m t m^T of symmetric tensors t of components XX YY ZZ XY YZ XZ.
HWY_INLINE void turn_tensors(const Matrix3& m, WideVec* t) {
  const WideVec column[3][3] = {{t[0], t[3], t[5]}, {t[3], t[1], t[4]}, {t[5], t[4], t[2]}};
  WideVec turned[3][3];  // m t
  for (int row = 0; row < 3; ++row) {
    for (int c = 0; c < 3; ++c) turned[row][c] = dot3(m.at[row], column[c]);
  }
  for (int axis = 0; axis < 3; ++axis) t[axis] = dot3(m.at[axis], turned[axis]);
  t[3] = dot3(m.at[1], turned[0]);
  t[4] = dot3(m.at[2], turned[1]);
  t[5] = dot3(m.at[2], turned[0]);
}

/// Components of as many successive voxels as WideTag has lanes. @pre 3 or 6 components
/// @param v  out, shape [8]
HWY_INLINE void load_voxels(const WideValues& values, int components, int voxel, WideVec* v) {
  for (int b = 0; b < (components == 3 ? 1 : 2); ++b, v += block_size) {
    hn::LoadInterleaved4(WideTag(), values.sum[b] + block_size * voxel, v[0], v[1], v[2], v[3]);
  }
}

/// Stores them. Those of voxels beyond the last one used have no meaning.
HWY_INLINE void store_voxels(const WideVec* v, int components, int voxel, WideValues& values) {
  for (int b = 0; b < (components == 3 ? 1 : 2); ++b, v += block_size) {
    hn::StoreInterleaved4(v[0], v[1], v[2], v[3], WideTag(), values.sum[b] + block_size * voxel);
  }
}

/// Reorients the values of voxels [begin, end).
/// @param components  three: vectors, six: tensors
/// @param to          out, in the order of `values`; up to seven voxels from `end` on change too
inline void reorient_voxels(const Matrix3& matrix,
                            int components,
                            const WideValues& values,
                            int begin,
                            int end,
                            WideValues& to) {
  for (int voxel = begin; voxel < end; voxel += static_cast<int>(hn::Lanes(WideTag()))) {
    WideVec v[2 * block_size];
    load_voxels(values, components, voxel, v);
    if (components == 3) {
      turn_vectors(matrix, v);
    } else {
      turn_tensors(matrix, v);
    }
    store_voxels(v, components, voxel, to);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
