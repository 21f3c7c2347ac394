/// @file row_hex-inl.hpp
/// Samples of voxels in hexahedra with a curved map, for filters nearest and linear with float32
/// arithmetic: Newton's method for the voxels of a row at a time, with the bits of hex_map.hpp.
/// Included once per vector instruction set.
#if defined(TETWARP_ROW_HEX_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_HEX_INL
#undef TETWARP_ROW_HEX_INL
#else
#define TETWARP_ROW_HEX_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/warp/cpu/rows/row_source-inl.hpp"
#include "host/warp/cpu/rows/row_taps-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using HexTag = hn::CappedTag<double, cell_edge>;  ///< voxels of a row, eight at most
using HexNumbers = hn::Vec<HexTag>;

/// The hexahedra that own voxels of a line of cells by a curved map.
class LineHexes {
 public:
  void clear() {
    shapes_.clear();
    parts_.clear();
    last_ = nullptr;
  }

  /// Adds tetrahedron t, a part of a hexahedron. @returns its number here
  int add(const RasterGeometry& job, std::int64_t t) {
    const HexMesh mesh{job.hexes, job.tets, job.nodes, job.rest};
    if (job.hexes.nodes_of(t) != last_) shapes_.push_back(make_hex_shape(mesh, t));
    last_ = job.hexes.nodes_of(t);
    const int shape = static_cast<int>(shapes_.size()) - 1;
    parts_.push_back({shape, make_hex_start(mesh, shapes_.back(), t, job.setups[t])});
    return static_cast<int>(parts_.size()) - 1;
  }

  /// A tetrahedron: its hexahedron, and where Newton's method begins.
  struct Part {
    int shape;
    HexStart start;
  };

  const Part& part(int number) const { return parts_[static_cast<std::size_t>(number)]; }
  const HexShape& shape(int number) const { return shapes_[static_cast<std::size_t>(number)]; }

 private:
  std::vector<HexShape> shapes_;
  std::vector<Part> parts_;
  const std::int32_t* last_ = nullptr;  ///< nodes of the last shape
};

/// map_hex() of a vector of voxels.
struct HexPlaces {
  HexNumbers x[3];
  HexNumbers gradient[3][3];  ///< [row][axis]

  HWY_INLINE HexPlaces(const HexTerms& hex, const HexNumbers* u) {
    const HexTag d;
    for (int row = 0; row < 3; ++row) {
      const auto t = [&](int term) { return hn::Set(d, hex.at[row][term]); };
      const auto turned = hn::Add(t(5), hn::Mul(u[0], t(7)));
      const auto across = hn::Add(t(6), hn::Mul(u[1], t(7)));
      const auto along = hn::Add(hn::Add(t(1), hn::Mul(u[1], t(4))), hn::Mul(u[2], across));
      const auto slope = hn::Add(t(3), hn::Mul(u[1], t(5)));
      const auto start = hn::Add(hn::Add(t(0), hn::Mul(u[1], t(2))), hn::Mul(u[2], slope));
      gradient[row][0] = along;
      gradient[row][1] = hn::Add(hn::Add(t(2), hn::Mul(u[0], t(4))), hn::Mul(u[2], turned));
      gradient[row][2] = hn::Add(hn::Add(t(3), hn::Mul(u[0], t(6))), hn::Mul(u[1], turned));
      x[row] = hn::Add(start, hn::Mul(u[0], along));
    }
  }
};

/// newton_step() of a vector of voxels. @returns where the map is not singular
HWY_INLINE hn::Mask<HexTag> hex_steps(const HexPlaces& at,
                                      const HexNumbers* left,
                                      HexNumbers* step) {
  const HexTag d;
  const auto& g = at.gradient;
  HexNumbers cofactor[3][3];
  for (int row = 0; row < 3; ++row) {
    const int r1 = (row + 1) % 3, r2 = (row + 2) % 3;
    for (int column = 0; column < 3; ++column) {
      const int c1 = (column + 1) % 3, c2 = (column + 2) % 3;
      cofactor[row][column] = hn::Sub(hn::Mul(g[r1][c1], g[r2][c2]), hn::Mul(g[r1][c2], g[r2][c1]));
    }
  }
  const auto det =
      hn::Add(hn::Add(hn::Mul(g[0][0], cofactor[0][0]), hn::Mul(g[0][1], cofactor[0][1])),
              hn::Mul(g[0][2], cofactor[0][2]));
  const auto scale = hn::Div(hn::Set(d, 1.0), det);
  for (int axis = 0; axis < 3; ++axis) {
    const auto sum =
        hn::Add(hn::Add(hn::Mul(cofactor[0][axis], left[0]), hn::Mul(cofactor[1][axis], left[1])),
                hn::Mul(cofactor[2][axis], left[2]));
    step[axis] = hn::Mul(scale, sum);
  }
  return hn::Ne(det, hn::Zero(d));
}

/// invert_hex() of a vector of voxels.
/// @param target  positions
/// @param u       in and out, local coordinates
/// @param wanted  voxels to compute
/// @returns those for which every whole step came nearer; the others are not set
HWY_INLINE hn::Mask<HexTag> invert_hexes(const HexTerms& hex,
                                         const HexNumbers* target,
                                         HexNumbers* u,
                                         hn::Mask<HexTag> wanted) {
  const HexTag d;
  const auto low = hn::Set(d, -hex_margin), high = hn::Set(d, 1 + hex_margin);
  HexNumbers left[3];
  const auto distance = [&](const HexPlaces& at, HexNumbers* short_of) {
    for (int axis = 0; axis < 3; ++axis) short_of[axis] = hn::Sub(target[axis], at.x[axis]);
    return hn::Max(hn::Abs(short_of[0]), hn::Max(hn::Abs(short_of[1]), hn::Abs(short_of[2])));
  };
  HexPlaces at(hex, u);
  auto far = distance(at, left);
  auto good = wanted;
  for (int step = 0; step < max_map_steps; ++step) {
    const auto open = hn::And(good, hn::Gt(far, hn::Set(d, map_tolerance)));
    if (hn::AllFalse(d, open)) return good;
    HexNumbers full[3], tried[3];
    const auto is_regular = hex_steps(at, left, full);
    for (int axis = 0; axis < 3; ++axis) {
      tried[axis] = hn::Min(hn::Max(hn::Add(u[axis], full[axis]), low), high);
      tried[axis] = hn::IfThenElse(open, tried[axis], u[axis]);
    }
    at = HexPlaces(hex, tried);
    const auto now = distance(at, left);
    good = hn::AndNot(hn::AndNot(hn::And(is_regular, hn::Lt(now, far)), open), good);
    far = now;
    for (int axis = 0; axis < 3; ++axis) u[axis] = tried[axis];
  }
  return good;
}

/// Source positions of the voxels of a row of a cell: whole voxels of the source's window, and a
/// local part from 0 to 1.
struct HexRow {
  alignas(64) std::int32_t whole[3][cell_edge];
  alignas(64) float local[3][cell_edge];

  void set(const HexMap& map, const int* voxel, const double* origin, int lane) {
    int at_whole[3];
    double at[3];
    hex_source_position(map, voxel, at_whole, at);
    for (int axis = 0; axis < 3; ++axis) {
      whole[axis][lane] = at_whole[axis] - static_cast<int>(origin[axis]);
      local[axis][lane] = static_cast<float>(at[axis]);
    }
  }
};

/// hex_source_position() of the voxels of row (j, k) of a cell that runs of one hexahedron own.
/// @param origin  first voxel of the source's window
inline void set_hex_row(const LineHexes& hexes,
                        const RowSource* sources,
                        const RowRun* const* runs,
                        int run_count,
                        const double* origin,
                        int j,
                        int k,
                        HexRow& row) {
  const HexTag d;
  const hn::Rebind<float, HexTag> df;
  const hn::Rebind<std::int32_t, HexTag> di;
  const int* const corner = sources[runs[0]->source].corner();
  const HexShape& shape = hexes.shape(hexes.part(sources[runs[0]->source].hex_part()).shape);
  const auto from = [&](int axis, int voxel) {
    return static_cast<double>(corner[axis] + voxel - shape.from[axis]);
  };
  unsigned all = 0;
  for (int r = 0; r < run_count; ++r) all |= runs[r]->bits;
  for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
    const auto mask_of = [&](unsigned bits) {
      const std::uint8_t part[8] = {static_cast<std::uint8_t>(bits >> lane)};
      return hn::LoadMaskBits(d, part);
    };
    const auto wanted = mask_of(all);
    if (hn::AllFalse(d, wanted)) continue;
    const HexNumbers target[3] = {
        hn::Add(hn::Set(d, from(0, 0)), hn::Iota(d, static_cast<double>(lane))),
        hn::Set(d, from(1, j)), hn::Set(d, from(2, k))};
    HexNumbers u[3];
    for (int r = 0; r < run_count; ++r) {
      const auto& start = hexes.part(sources[runs[r]->source].hex_part()).start.at;
      const auto mine = mask_of(runs[r]->bits);
      for (int axis = 0; axis < 3; ++axis) {
        const double of_row =
            (start[3][axis] + start[1][axis] * from(1, j)) + start[2][axis] * from(2, k);
        const auto at = hn::Add(hn::Set(d, of_row), hn::Mul(hn::Set(d, start[0][axis]), target[0]));
        u[axis] = r == 0 ? at : hn::IfThenElse(mine, at, u[axis]);
      }
    }
    const auto good = invert_hexes(shape.output, target, u, wanted);
    const HexPlaces at(shape.source, u);
    for (int axis = 0; axis < 3; ++axis) {
      const auto first = hn::Set(d, static_cast<double>(shape.whole[axis]));
      const auto limit = hn::Set(d, max_whole);
      const auto whole = hn::Add(hn::Floor(at.x[axis]), first);
      const auto near = hn::Min(hn::Max(whole, hn::Neg(limit)), limit);
      const auto local = hn::Sub(at.x[axis], hn::Sub(near, first));
      hn::Store(hn::DemoteTo(df, local), df, row.local[axis] + lane);
      hn::Store(hn::DemoteTo(di, hn::Sub(near, hn::Set(d, origin[axis]))), di,
                row.whole[axis] + lane);
    }
    if (hn::AllTrue(d, hn::Or(good, hn::Not(wanted)))) continue;
    std::uint8_t left[8] = {};
    hn::StoreMaskBits(d, hn::AndNot(good, wanted), left);
    for (unsigned bits = left[0]; bits != 0; bits &= bits - 1) {
      const int i = static_cast<int>(lane) + std::countr_zero(bits);
      const auto owner = *std::find_if(
          runs, runs + run_count, [&](const RowRun* run) { return (run->bits >> i & 1) != 0; });
      const auto& part = hexes.part(sources[owner->source].hex_part());
      const int voxel[3] = {corner[0] + i, corner[1] + j, corner[2] + k};
      row.set({shape, part.start}, voxel, origin, i);
    }
  }
}

/// Where the neighbors of some voxels are.
enum class HexReach {
  inner,  ///< all in the source
  rim,    ///< some are clamped, or the position is outside
  end     ///< reads in vectors might pass the end of the source
};

inline HexReach reach_of_row(const SourceShape& source, const HexRow& row, unsigned bits) {
  HexReach reach = HexReach::inner;
  for (; bits != 0; bits &= bits - 1) {
    const int i = std::countr_zero(bits);
    bool meets_end = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int whole = row.whole[axis][i];
      if (whole < 1 || whole > source.dims[axis] - 3) reach = HexReach::rim;
      meets_end = meets_end && whole + 2 > source.end[axis] - source.origin[axis];
    }
    if (meets_end) return HexReach::end;
  }
  return reach;
}

/// Adds one unit: voxels of a row of a cell, see add_unit().
template <bool is_rim>
inline void add_hex_unit(const SourceShape& source,
                         bool nearest,
                         const HexRow& row,
                         const RowSource& first,
                         std::uint16_t cell,
                         unsigned bits,
                         RowTaps<is_rim>& taps) {
  const RowTag d;
  const RowIntTag di;
  const auto at = static_cast<std::size_t>(cell_edge * taps.count);
  const int some = std::countr_zero(bits);  // voxels of no run take its taps, which are readable
  unsigned inside = is_rim ? 0 : 0xff;
  const int line = source.dims[0], slice = line * source.dims[1];
  for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
    const auto mine = lanes_of(bits, lane);
    RowPositions<is_rim> x;
    hn::Vec<RowIntTag> whole[3];
    for (int axis = 0; axis < 3; ++axis) {
      x.local[axis] = hn::IfThenElse(mine, hn::Load(d, row.local[axis] + lane),
                                     hn::Set(d, row.local[axis][some]));
      whole[axis] = hn::IfThenElse(hn::RebindMask(di, mine), hn::Load(di, row.whole[axis] + lane),
                                   hn::Set(di, row.whole[axis][some]));
      if constexpr (is_rim) x.whole[axis] = whole[axis];
    }
    if constexpr (!is_rim) {
      constexpr std::uint32_t shift = std::bit_cast<std::uint32_t>(whole_shift);
      const auto shifts = shift * static_cast<std::uint32_t>(slice + line + 1);
      const auto start = hn::Add(hn::Add(whole[0], hn::Mul(whole[1], hn::Set(di, line))),
                                 hn::Mul(whole[2], hn::Set(di, slice)));
      x.whole[0] = hn::Sub(start, hn::Set(di, static_cast<std::int32_t>(shifts)));
    }
    const auto in_source = store_taps(source, nearest, x, at + lane, taps);
    if constexpr (is_rim) inside |= bits_of(in_source, lane);
  }
  for (const std::size_t voxel : {0, cell_edge / 2}) {
    fetch_next_rows(first, source.data + source.voxel_bytes * taps.offset[0][at + voxel]);
  }
  taps.unit[taps.count++] = {cell, static_cast<std::uint8_t>(bits),
                             static_cast<std::uint8_t>(bits & inside)};
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
