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

#include "host/warp/cpu/rows/row_reorient-inl.hpp"
#include "host/warp/cpu/rows/row_wide_values-inl.hpp"
#include "kernels/warp/voxel_transform.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Eigenvalues of tensors in descending order, and the first and the third eigenvector.
struct PrincipalAxes {
  static constexpr int voxels = WideValues::voxels + WideValues::padding;
  alignas(64) double value[3][voxels];
  alignas(64) double first[3][voxels];
  alignas(64) double third[3][voxels];
};

/// Tensors of one voxel per lane, to be diagonalized by find_eigenvectors().
struct TensorLanes {
  WideVec a[3][3];
  WideVec vectors[3][3];
  WideVec least;  ///< entries up to it count as zero
};

/// A rotation of symmetric_eigen().
struct PlaneTurn {
  hn::Mask<WideTag> turns;  ///< of lanes that need it
  WideVec cosine, sine;
};

/// The rotation in the plane of axes p and q.
HWY_INLINE PlaneTurn plane_turn(const TensorLanes& t, int p, int q) {
  const WideTag d;
  const auto one = hn::Set(d, 1.0);
  const auto difference = hn::Sub(t.a[q][q], t.a[p][p]);
  const auto slope = hn::Div(difference, hn::Mul(hn::Set(d, 2.0), t.a[p][q]));
  const auto root = hn::Sqrt(hn::Add(hn::Mul(slope, slope), one));
  const auto tangent = hn::CopySign(hn::Div(one, hn::Add(hn::Abs(slope), root)), slope);
  const auto cosine = hn::Div(one, hn::Sqrt(hn::Add(hn::Mul(tangent, tangent), one)));
  return {hn::Not(hn::Le(hn::Abs(t.a[p][q]), t.least)), cosine, hn::Mul(tangent, cosine)};
}

HWY_INLINE void apply(const PlaneTurn& by, int p, int q, TensorLanes& t) {
  const auto turn = [&](WideVec& at_p, WideVec& at_q) {
    const auto new_p = hn::Sub(hn::Mul(by.cosine, at_p), hn::Mul(by.sine, at_q));
    const auto new_q = hn::Add(hn::Mul(by.sine, at_p), hn::Mul(by.cosine, at_q));
    at_p = hn::IfThenElse(by.turns, new_p, at_p);
    at_q = hn::IfThenElse(by.turns, new_q, at_q);
  };
  for (int r = 0; r < 3; ++r) {
    turn(t.a[r][p], t.a[r][q]);
    turn(t.vectors[r][p], t.vectors[r][q]);
  }
  for (int r = 0; r < 3; ++r) turn(t.a[p][r], t.a[q][r]);
  t.a[p][q] = hn::IfThenZeroElse(by.turns, t.a[p][q]);
  t.a[q][p] = hn::IfThenZeroElse(by.turns, t.a[q][p]);
}

/// Sets `vectors` and `least` for a tensor.
HWY_INLINE void begin_turns(TensorLanes& t) {
  const WideTag d;
  auto largest = hn::Zero(d);
  for (int p = 0; p < 3; ++p) {
    for (int q = 0; q < 3; ++q) {
      t.vectors[p][q] = hn::Set(d, p == q ? 1.0 : 0.0);
      const auto size = hn::Abs(t.a[p][q]);
      largest = hn::IfThenElse(hn::Lt(largest, size), size, largest);
    }
  }
  t.least = hn::Mul(hn::Set(d, 0x1p-64), largest);
}

/// symmetric_eigen() of three rows. A lane whose entries off the diagonal count as zero does not
/// change in further sweeps, so that lanes may need different numbers of them. Divisions and roots
/// of two vectors overlap in time.
HWY_INLINE void find_eigenvectors(TensorLanes* two) {
  const WideTag d;
  constexpr int planes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  begin_turns(two[0]);
  begin_turns(two[1]);
  bool has_turned = true;
  for (int sweep = 0; sweep < 10 && has_turned; ++sweep) {
    has_turned = false;
    for (const auto& [p, q] : planes) {
      const PlaneTurn first = plane_turn(two[0], p, q), second = plane_turn(two[1], p, q);
      if (hn::AllFalse(d, hn::Or(first.turns, second.turns))) continue;
      has_turned = true;
      apply(first, p, q, two[0]);
      apply(second, p, q, two[1]);
    }
  }
}

/// Sorts eigenvalues and eigenvectors and stores them from `voxel` on.
HWY_INLINE void store_axes(const TensorLanes& t, int voxel, PrincipalAxes& axes) {
  const WideTag d;
  WideVec value[3] = {t.a[0][0], t.a[1][1], t.a[2][2]}, vectors[3][3];
  for (int row = 0; row < 3; ++row) std::copy_n(t.vectors[row], 3, vectors[row]);
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

/// Finds the axes of the tensors of all voxels. Sets the values behind the last voxel to zero.
HWY_NOINLINE inline void find_axes(WideValues& values, PrincipalAxes& axes) {
  const int lanes = static_cast<int>(hn::Lanes(WideTag()));
  for (auto& sum : values.sum) {
    std::fill_n(sum + block_size * values.count, block_size * WideValues::padding, 0.0);
  }
  for (int voxel = 0; voxel < values.count; voxel += 2 * lanes) {
    TensorLanes two[2];
    for (int n = 0; n < 2; ++n) {
      WideVec t[2 * block_size];
      load_voxels(values, 6, voxel + lanes * n, t);
      const WideVec a[3][3] = {{t[0], t[3], t[5]}, {t[3], t[1], t[4]}, {t[5], t[4], t[2]}};
      for (int row = 0; row < 3; ++row) std::copy_n(a[row], 3, two[n].a[row]);
    }
    find_eigenvectors(two);
    for (int n = 0; n < 2; ++n) store_axes(two[n], voxel + lanes * n, axes);
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
