/// @file cell_sides-inl.hpp
/// Which voxels of a cell lie inside a tetrahedron, by exact intervals of its rows. Included once
/// per vector instruction set (the name and the toggled guard are Highway's convention).
#if defined(TETWARP_CELL_SIDES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_CELL_SIDES_INL
#undef TETWARP_CELL_SIDES_INL
#else
#define TETWARP_CELL_SIDES_INL
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstdint>
#include <cstring>

#include "kernels/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Bit 8 j + i of a slice is voxel (i, j).
using SliceBits = std::uint64_t;

/// Voxels of one slice that lie inside for certain, or that certain_side() must be asked about.
struct SliceSides {
  SliceBits inside = 0;
  SliceBits unsure = 0;
};

/// Where rows cross the planes of a tetrahedron, ready for vectors of rows.
///
/// On a row a plane is line + step i, so it is above `margin` from (margin - line) / step on. With
/// the unit of CellPlanes, certain_side() is open only where |line + step i| <= 1.05; rounding of
/// the quotient costs less than 3 u |line| < 0.4 more. Beyond the margin both agree.
struct RowCrossings {
  static constexpr float margin = 2.0f;
  static constexpr float flattest = 0x1p-3f;  ///< steps below move a row by less than `margin` / 2

  explicit RowCrossings(const CellPlanes& cell_planes) : planes(cell_planes) {
    for (int face = 0; face < 4; ++face) {
      const float step = planes.step[0][face];
      const bool is_flat = std::fabs(step) < flattest;
      reciprocal[face] = is_flat ? 0.0f : 1.0f / step;
      kind[face] = is_flat ? 0 : step > 0 ? 1 : -1;
    }
  }

  const CellPlanes& planes;
  float reciprocal[4];
  int kind[4];  ///< +1: rows enter through the face, -1: they leave, 0: they run along it
};

/// Sides of the voxels of slices [k_begin, k_end) of a cell.
inline void cell_sides(const CellPlanes& planes, int k_begin, int k_end, SliceSides* sides) {
  const hn::CappedTag<float, cell_edge> d;  // one lane per row
  const hn::RebindToSigned<decltype(d)> di;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  const RowCrossings crossings(planes);
  const auto margin = hn::Set(d, RowCrossings::margin), edge = hn::Set(d, float{cell_edge});
  const auto zero = hn::Zero(d);
  for (int k = k_begin; k < k_end; ++k) {
    alignas(8) std::uint8_t inside[cell_edge], possible[cell_edge];
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      const auto j = hn::Iota(d, static_cast<float>(lane));
      auto enter = zero, enter_early = zero, leave = edge, leave_late = edge;
      for (int face = 0; face < 4; ++face) {
        const auto along_j = hn::Mul(j, hn::Set(d, planes.step[1][face]));
        const auto above = hn::Set(d, planes.step[2][face] * static_cast<float>(k));
        const auto line = hn::Add(hn::Add(hn::Set(d, planes.value[face]), along_j), above);
        const auto inner = hn::Sub(margin, line), outer = hn::Sub(hn::Neg(margin), line);
        const auto reciprocal = hn::Set(d, crossings.reciprocal[face]);
        if (crossings.kind[face] > 0) {
          enter = hn::Max(enter, hn::Mul(inner, reciprocal));
          enter_early = hn::Max(enter_early, hn::Mul(outer, reciprocal));
        } else if (crossings.kind[face] < 0) {
          leave = hn::Min(leave, hn::Mul(inner, reciprocal));
          leave_late = hn::Min(leave_late, hn::Mul(outer, reciprocal));
        } else {
          leave = hn::IfThenElseZero(hn::Lt(inner, hn::Neg(hn::Set(d, 1.0f))), leave);
          leave_late = hn::IfThenElseZero(hn::Lt(outer, hn::Set(d, 1.0f)), leave_late);
        }
      }
      // Bits [ceil(from), ceil(to)) of a row.
      const auto row_bits = [&](auto from, auto to) {
        const auto first = hn::ConvertTo(di, hn::Ceil(hn::Min(from, edge)));
        const auto past = hn::ConvertTo(di, hn::Ceil(hn::Max(to, zero)));
        const auto all = hn::Set(di, -1);
        return hn::AndNot(hn::Shl(all, past), hn::Shl(all, first));
      };
      const auto bits8 = [&](auto bits) {
        return hn::TruncateTo(d8, hn::BitCast(hn::RebindToUnsigned<decltype(di)>(), bits));
      };
      hn::StoreU(bits8(row_bits(enter, leave)), d8, inside + lane);
      hn::StoreU(bits8(row_bits(enter_early, leave_late)), d8, possible + lane);
    }
    SliceBits possible_bits;
    std::memcpy(&sides[k].inside, inside, sizeof(inside));
    std::memcpy(&possible_bits, possible, sizeof(possible));
    sides[k].unsure = possible_bits & ~sides[k].inside;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
