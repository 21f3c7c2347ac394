/// @file row_principal-inl.hpp
/// Reorients tensors by preservation of the principal direction, one voxel per lane, bit-equal to
/// preserve_principal(). Included once per vector instruction set.
#if defined(TETWARP_ROW_PRINCIPAL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_PRINCIPAL_INL
#undef TETWARP_ROW_PRINCIPAL_INL
#else
#define TETWARP_ROW_PRINCIPAL_INL
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "host/warp/cpu/row_reorient-inl.hpp"
#include "host/warp/cpu/row_wide_values-inl.hpp"
#include "kernels/warp/voxel_transform.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Eigenvalues of tensors in descending order, and the first and the third eigenvector.
struct PrincipalAxes {
  static constexpr int voxels = WideValues::voxels + cell_edge;
  alignas(64) double value[3][voxels];
  alignas(64) double first[3][voxels];
  alignas(64) double third[3][voxels];
};

/// One rotation of symmetric_eigen() in the plane of axes p and q.
/// @param least  entries up to it count as zero
/// @returns whether a lane has turned
HWY_INLINE bool turn_plane(int p, int q, WideVec least, WideVec (*a)[3], WideVec (*vectors)[3]) {
  const WideTag d;
  const auto turns = hn::Not(hn::Le(hn::Abs(a[p][q]), least));
  if (hn::AllFalse(d, turns)) return false;
  const auto one = hn::Set(d, 1.0);
  const auto slope = hn::Div(hn::Sub(a[q][q], a[p][p]), hn::Mul(hn::Set(d, 2.0), a[p][q]));
  const auto root = hn::Sqrt(hn::Add(hn::Mul(slope, slope), one));
  const auto tangent = hn::CopySign(hn::Div(one, hn::Add(hn::Abs(slope), root)), slope);
  const auto cosine = hn::Div(one, hn::Sqrt(hn::Add(hn::Mul(tangent, tangent), one)));
  const auto sine = hn::Mul(tangent, cosine);
  const auto turn = [&](WideVec& at_p, WideVec& at_q) {
    const auto new_p = hn::Sub(hn::Mul(cosine, at_p), hn::Mul(sine, at_q));
    const auto new_q = hn::Add(hn::Mul(sine, at_p), hn::Mul(cosine, at_q));
    at_p = hn::IfThenElse(turns, new_p, at_p);
    at_q = hn::IfThenElse(turns, new_q, at_q);
  };
  for (int r = 0; r < 3; ++r) {
    turn(a[r][p], a[r][q]);
    turn(vectors[r][p], vectors[r][q]);
  }
  for (int r = 0; r < 3; ++r) turn(a[p][r], a[q][r]);
  a[p][q] = hn::IfThenZeroElse(turns, a[p][q]);
  a[q][p] = hn::IfThenZeroElse(turns, a[q][p]);
  return true;
}

/// symmetric_eigen() of three rows. A lane whose entries off the diagonal count as zero does not
/// change in further sweeps, so that lanes may need different numbers of them.
HWY_INLINE void find_eigenvectors(WideVec (*a)[3], WideVec (*vectors)[3]) {
  const WideTag d;
  auto largest = hn::Zero(d);
  for (int p = 0; p < 3; ++p) {
    for (int q = 0; q < 3; ++q) {
      vectors[p][q] = hn::Set(d, p == q ? 1.0 : 0.0);
      const auto size = hn::Abs(a[p][q]);
      largest = hn::IfThenElse(hn::Lt(largest, size), size, largest);
    }
  }
  const auto least = hn::Mul(hn::Set(d, 0x1p-64), largest);
  bool has_turned = true;
  for (int sweep = 0; sweep < 10 && has_turned; ++sweep) {
    has_turned = turn_plane(0, 1, least, a, vectors);
    has_turned = turn_plane(0, 2, least, a, vectors) || has_turned;
    has_turned = turn_plane(1, 2, least, a, vectors) || has_turned;
  }
}

/// Finds the axes of the tensors of all voxels. Sets the values behind the last voxel to zero.
HWY_NOINLINE inline void find_axes(WideValues& values, PrincipalAxes& axes) {
  const WideTag d;
  for (auto& sum : values.sum) {
    std::fill_n(sum + block_size * values.count, block_size * cell_edge, 0.0);
  }
  for (int voxel = 0; voxel < values.count; voxel += static_cast<int>(hn::Lanes(d))) {
    WideVec t[2 * block_size], vectors[3][3];
    load_voxels(values, 6, voxel, t);
    WideVec a[3][3] = {{t[0], t[3], t[5]}, {t[3], t[1], t[4]}, {t[5], t[4], t[2]}};
    find_eigenvectors(a, vectors);
    WideVec value[3] = {a[0][0], a[1][1], a[2][2]};
    for (int pass = 0; pass < 3; ++pass) {
      const int n = pass % 2, next = n + 1;
      const auto stays = hn::Ge(value[n], value[next]);
      const auto order = [&](WideVec& x, WideVec& y) {
        const auto before = x;
        x = hn::IfThenElse(stays, x, y);
        y = hn::IfThenElse(stays, y, before);
      };
      order(value[n], value[next]);
      for (auto& row : vectors) order(row[n], row[next]);
    }
    for (int row = 0; row < 3; ++row) {
      hn::StoreU(value[row], d, axes.value[row] + voxel);
      hn::StoreU(vectors[row][0], d, axes.first[row] + voxel);
      hn::StoreU(vectors[row][2], d, axes.third[row] + voxel);
    }
  }
}

/// Makes v a unit vector. @returns where it is not zero
HWY_INLINE hn::Mask<WideTag> normalize(WideVec* v) {
  const auto squares = hn::Add(hn::Mul(v[0], v[0]), hn::Mul(v[1], v[1]));
  const auto length = hn::Sqrt(hn::Add(squares, hn::Mul(v[2], v[2])));
  for (int row = 0; row < 3; ++row) v[row] = hn::Div(v[row], length);
  return hn::Gt(length, hn::Zero(WideTag()));
}

/// Reorients the tensors of voxels [begin, end), like reorient_voxels().
/// @param backward  the inverse of F
/// @param axes      of all voxels of `values`
inline void preserve_principals(const Matrix3& backward,
                                const PrincipalAxes& axes,
                                const WideValues& values,
                                int begin,
                                int end,
                                WideValues& to) {
  const WideTag d;
  const Matrix3 forward = forward_direction(backward), inverse = transposed(backward);
  for (int voxel = begin; voxel < end; voxel += static_cast<int>(hn::Lanes(d))) {
    WideVec t[2 * block_size], value[3], frame[3][3];
    load_voxels(values, 6, voxel, t);
    for (int row = 0; row < 3; ++row) {
      value[row] = hn::LoadU(d, axes.value[row] + voxel);
      frame[0][row] = hn::LoadU(d, axes.first[row] + voxel);
      frame[2][row] = hn::LoadU(d, axes.third[row] + voxel);
    }
    turn_vectors(forward, frame[0]);
    turn_vectors(inverse, frame[2]);
    const auto has_first = normalize(frame[0]), has_third = normalize(frame[2]);
    const auto is_defined = hn::And(has_first, has_third);
    for (int row = 0; row < 3; ++row) {
      const int r1 = (row + 1) % 3, r2 = (row + 2) % 3;
      frame[1][row] =
          hn::Sub(hn::Mul(frame[2][r1], frame[0][r2]), hn::Mul(frame[2][r2], frame[0][r1]));
    }
    constexpr int entry[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    for (int c = 0; c < 6; ++c) {
      auto sum = hn::Zero(d);
      for (int e = 0; e < 3; ++e) {
        const auto along = hn::Mul(value[e], frame[e][entry[c][0]]);
        sum = hn::Add(sum, hn::Mul(along, frame[e][entry[c][1]]));
      }
      t[c] = hn::IfThenElse(is_defined, sum, t[c]);
    }
    store_voxels(t, 6, voxel, to);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
