/// @file row_source-inl.hpp
/// The map of one tetrahedron over one cell, and the runs of a row that share an owner. Included
/// once per vector instruction set.
#if defined(TETWARP_ROW_SOURCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_SOURCE_INL
#undef TETWARP_ROW_SOURCE_INL
#else
#define TETWARP_ROW_SOURCE_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "host/warp/cpu/rows/row_scalar.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// How the voxels that a tetrahedron owns in a cell are sampled.
enum class RowKind : std::uint8_t {
  inner,   ///< in vectors of float32 positions; all neighbors are in the source
  rim,     ///< in vectors; positions may lie outside the source and neighbors are clamped
  alone,   ///< voxel by voxel: steep maps, float64, sources of 2^31 voxels or more
  curved,  ///< in hexahedra: in vectors of float64 positions
  copied   ///< moved by whole voxels
};

/// The members of a SourceView that do not depend on the pixel type. The bounds limit the positions
/// at which it may be read in vectors: one entry per axis; the fourth pads to four lanes, and every
/// position passes it.
struct SourceShape {
  template <class T>
  explicit SourceShape(const SourceView<T>& source)
      : data(reinterpret_cast<const std::byte*>(source.data)),
        sample_bytes(sizeof(T)),
        constants(data),
        constant_bytes(sizeof(T)),
        dims{source.dims[0], source.dims[1], source.dims[2]},
        components(source.components),
        voxel_bytes(sample_bytes * components) {
    for (int axis = 0; axis < 3; ++axis) origin[axis] = source.origin[axis];
    if (source.coefficients != nullptr) {
      constants = reinterpret_cast<const std::byte*>(source.coefficients);
      constant_bytes = sizeof(ArithmeticOf<T>);
    }
    set_bounds(sizeof(ArithmeticOf<T>) == 4);
  }

  const std::byte* data;
  std::ptrdiff_t sample_bytes;
  /// What constant_value() reads: the samples, or the coefficients of the spline.
  const std::byte* constants;
  std::ptrdiff_t constant_bytes;  ///< per component of a voxel
  int dims[3];
  int components;
  std::ptrdiff_t voxel_bytes;
  bool is_vectored;
  double origin[4] = {0, 0, 0, 0};      ///< first voxel that the view holds
  double inner_low[4] = {0, 0, 0, -1};  ///< between low and high no neighbor is clamped
  double inner_high[4] = {0, 0, 0, 1};
  double end[4] = {0, 0, 0, -1};  ///< above it on all axes a read may pass the end of the source

 private:
  void set_bounds(bool is_float32) {
    const double voxels = static_cast<double>(dims[0]) * dims[1] * dims[2];
    is_vectored = is_float32 && voxels <= std::numeric_limits<std::int32_t>::max();
    // A read of two neighbors along x takes eight bytes, a read of components takes four at a
    // time: either may extend up to `spare` voxels beyond the second neighbor.
    const int spare = components == 1 ? 8 / static_cast<int>(sample_bytes) - 1 : 2;
    // In narrow sources these voxels extend over several rows or slices.
    constexpr double slack = 0.51;  // nearest rounds up
    double voxels_per_step = 1;
    for (int axis = 0; axis < 3; ++axis) {
      inner_low[axis] = origin[axis] + 0.01;
      inner_high[axis] = origin[axis] + dims[axis] - 1 - slack;
      end[axis] = inner_high[axis] - std::ceil(spare / voxels_per_step);
      voxels_per_step *= dims[axis];
    }
  }
};

/// Adding this to a whole number below 2^22 moves the number to the low bits of the float32,
/// without the checks of a conversion. Local positions of RowKind::inner are below 100 voxels.
constexpr float whole_shift = 0x1.8p23f;

/// The map of one tetrahedron relative to one cell, bit-equal to make_source_map().
class RowSource {
 public:
  RowSource(const RasterGeometry& job,
            const SourceShape& source,
            const TetSetup& tet,
            const int* corner,
            int number)
      : setup_(&tet), number_(number), corner_{corner[0], corner[1], corner[2]} {
    set_map(source);
    if (!source.is_vectored || tet.kind == MapKind::steep) kind_ = RowKind::alone;
    if (source.is_vectored && tet.kind == MapKind::trilinear) kind_ = RowKind::curved;
    if (is_copied(job, tet)) kind_ = RowKind::copied;
    const std::int64_t line = source.dims[0], slice = line * source.dims[1];
    origin_ = whole[2] * slice + whole[1] * line + whole[0];
    constexpr std::int64_t shift = std::bit_cast<std::int32_t>(whole_shift);
    tap_origin_ =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(origin_ - shift * (slice + line + 1)));
    look_ahead(line, slice, source.voxel_bytes);
  }

  RowKind kind() const { return kind_; }
  int tet() const { return number_; }
  const TetSetup& setup() const { return *setup_; }
  const int* corner() const { return corner_; }
  RowMap map() const { return {number_, *setup_, corner_, base, axis, whole}; }

  /// Of RowKind::curved, its number in LineHexes.
  int hex_part() const { return hex_part_; }
  void set_hex_part(int part) { hex_part_ = part; }

  /// The voxel at the map's whole part; it may lie outside the source.
  std::int64_t origin() const { return origin_; }
  /// The same modulo 2^32, less what whole_shift on each axis adds to an offset from it.
  std::int32_t tap_origin() const { return tap_origin_; }
  /// Distances in memory from a voxel's samples to two places to prefetch for the next rows [byte].
  std::int64_t ahead() const { return ahead_; }
  std::int64_t ahead_too() const { return ahead_too_; }

  // The parts of SourceMap<float>.
  alignas(16) float base[4];
  alignas(16) float axis[3][4];
  alignas(16) std::int32_t whole[4];

 private:
  void set_map(const SourceShape& source) {
    const hn::CappedTag<double, 4> d;  // one lane per axis of the source
    const hn::Rebind<float, decltype(d)> df;
    const hn::Rebind<std::int32_t, decltype(d)> di;
    const auto zero = hn::Zero(d);
    bool is_inner = true, meets_end = true;
    for (std::size_t lane = 0; lane < 4; lane += hn::Lanes(d)) {
      auto start = zero, below = zero, above = zero;
      for (int a = 0; a < 3; ++a) {
        const auto step = hn::LoadU(d, setup_->map[a] + lane);
        const auto from = hn::Set(d, static_cast<double>(corner_[a] - setup_->anchor[a]));
        start = a == 0 ? hn::Mul(step, from) : hn::Add(start, hn::Mul(step, from));
        const auto reach = hn::Mul(step, hn::Set(d, double{cell_edge - 1}));
        below = hn::Add(below, hn::Min(reach, zero));
        above = hn::Add(above, hn::Max(reach, zero));
        hn::Store(hn::DemoteTo(df, step), df, axis[a] + lane);
      }
      start = hn::Add(start, hn::LoadU(d, setup_->map[3] + lane));
      const auto limit = hn::Set(d, max_whole);
      const auto floor = hn::Floor(hn::Min(hn::Max(start, hn::Neg(limit)), limit));
      hn::Store(hn::DemoteTo(df, hn::Sub(start, floor)), df, base + lane);
      const auto local = hn::Sub(floor, hn::LoadU(d, source.origin + lane));
      hn::Store(hn::DemoteTo(di, local), di, whole + lane);
      const auto low = hn::Add(start, below), high = hn::Add(start, above);
      is_inner = is_inner && hn::AllTrue(d, hn::Gt(low, hn::LoadU(d, source.inner_low + lane))) &&
                 hn::AllTrue(d, hn::Lt(high, hn::LoadU(d, source.inner_high + lane)));
      meets_end = meets_end && hn::AllTrue(d, hn::Gt(high, hn::LoadU(d, source.end + lane)));
    }
    if (!meets_end) kind_ = is_inner ? RowKind::inner : RowKind::rim;
  }

  /// Sets the prefetch distances. Rows that run along lines of the source next read lines of the
  /// next slice. Rows that run across lines next read what the neighboring line of cells reads,
  /// one row further.
  void look_ahead(std::int64_t line, std::int64_t slice, std::ptrdiff_t voxel_bytes) {
    const hn::FixedTag<float, 4> d;
    const hn::RebindToSigned<decltype(d)> di;
    const bool is_across = std::abs(axis[0][1]) + std::abs(axis[0][2]) > 0.5f;
    const auto step = is_across ? hn::Mul(hn::Load(d, axis[1]), hn::Set(d, float{cell_edge + 1}))
                                : hn::Load(d, axis[2]);
    alignas(16) std::int32_t voxels[4];
    hn::Store(hn::ConvertTo(di, hn::Round(step)), di, voxels);
    const std::int64_t ahead = voxels[2] * slice + voxels[1] * line + voxels[0];
    ahead_ = (ahead + (is_across ? 0 : slice)) * voxel_bytes;
    ahead_too_ = ahead_ + (is_across ? slice : line) * voxel_bytes;
  }

  const TetSetup* setup_;
  int number_;
  int hex_part_ = -1;
  RowKind kind_ = RowKind::alone;
  int corner_[3];
  std::int64_t origin_ = 0;
  std::int32_t tap_origin_ = 0;
  std::int64_t ahead_ = 0;
  std::int64_t ahead_too_ = 0;
};

/// Voxels of one row of a cell that one tetrahedron owns.
struct RowRun {
  std::int32_t source;  ///< index of its RowSource in the line
  std::uint16_t cell;   ///< number in the line
  std::uint8_t bits;    ///< bit i: voxel i of the row
  RowKind kind;         ///< of the source
};

/// Prefetches what the next rows read near a sample. Always inlined: g++ 12 takes a function that
/// only prefetches for one without effect, and removes calls of it in loops.
HWY_INLINE void fetch_next_rows(const RowSource& source, const void* sample) {
  const auto* const at = static_cast<const std::byte*>(sample);
  hwy::Prefetch(at + source.ahead());
  hwy::Prefetch(at + source.ahead_too());
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
