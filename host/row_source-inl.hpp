/// @file row_source-inl.hpp
/// The map of one tetrahedron over one cell, and the runs of a row that share an owner. Included
/// once per vector instruction set (the name and the toggled guard are Highway's convention).
#if defined(TETWARP_ROW_SOURCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_SOURCE_INL
#undef TETWARP_ROW_SOURCE_INL
#else
#define TETWARP_ROW_SOURCE_INL
#endif

#include <hwy/highway.h>

#include <cstdint>
#include <limits>

#include "kernels/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using RowTag = hn::CappedTag<float, cell_edge>;  ///< positions of a row, eight at most
using RowIntTag = hn::RebindToSigned<RowTag>;
using PairTag = hn::CappedTag<std::uint64_t, cell_edge>;  ///< one x-pair of samples per lane
using PairIntTag = hn::RebindToSigned<PairTag>;
using PairFloatTag = hn::Repartition<float, PairTag>;
using PairHalfTag = hn::Rebind<std::uint32_t, PairTag>;

/// Mask of the vector that starts at voxel `lane` of a row.
inline hn::Mask<RowTag> lanes_of(unsigned bits, std::size_t lane) {
  const std::uint8_t part[8] = {static_cast<std::uint8_t>(bits >> lane)};
  return hn::LoadMaskBits(RowTag(), part);
}

inline unsigned bits_of(hn::Mask<RowTag> mask, std::size_t lane) {
  std::uint8_t part[8] = {};
  hn::StoreMaskBits(RowTag(), mask, part);
  return unsigned{part[0]} << lane;
}

/// How the voxels that a tetrahedron owns in a cell are sampled.
enum class RowKind {
  inner,  ///< a vector of float32 positions, none near the source's rim
  rim,    ///< the same, but positions may lie outside and neighbours are clamped
  alone   ///< voxel by voxel: copies, steep maps, float64, several components, huge sources
};

template <class T>
class RowSource {
 public:
  RowSource(const RasterJob<T>& job, const TetSetup& tet, const int* corner, int number)
      : setup_(&tet), number_(number) {
    double start[3], linear[3][3];
    map_start(tet, corner[0], corner[1], corner[2], start, linear);
    map_ = make_source_map<float>(start, linear);
    kind_ = RowKind::alone;
    if (sizeof(ArithmeticOf<T>) == 4 && tet.kind != MapKind::steep && !is_copied(job, tet)) {
      kind_ = kind_over_cell(job.source, start, linear);
    }
    for (int axis = 0; axis < 3; ++axis) corner_[axis] = corner[axis];
    for (int axis = 2; axis >= 0; --axis) {
      const auto step = static_cast<std::int64_t>(cell_edge * map_.axis[0][axis]);
      ahead_ = ahead_ * job.source.dims[axis] + step;
    }
  }

  RowKind kind() const { return kind_; }
  int tet() const { return number_; }
  const TetSetup& setup() const { return *setup_; }
  const SourceMap<float>& map() const { return map_; }
  const int* corner() const { return corner_; }

  /// From a sample to the one eight voxels further along the row, about [sample].
  std::int64_t ahead() const { return ahead_; }

  /// local_position() along axis `axis` of the vector of row (j, k) that starts at `lane`.
  hn::Vec<RowTag> position(int axis, std::size_t lane, int j, int k) const {
    const RowTag d;
    const float line = (map_.base[axis] + map_.axis[1][axis] * static_cast<float>(j)) +
                       map_.axis[2][axis] * static_cast<float>(k);
    const auto i = hn::Iota(d, static_cast<float>(lane));
    return hn::Add(hn::Set(d, line), hn::Mul(hn::Set(d, map_.axis[0][axis]), i));
  }

 private:
  /// The kind by the box of all positions over the cell.
  static RowKind kind_over_cell(const SourceView<T>& source,
                                const double* start,
                                const double (*linear)[3]) {
    const double samples = static_cast<double>(source.dims[0]) * source.dims[1] * source.dims[2];
    if (source.components != 1 || samples > std::numeric_limits<std::int32_t>::max()) {
      return RowKind::alone;
    }
    // A read of two neighbours along x takes four bytes at least: it may touch `spare` more.
    const int spare = sizeof(T) == 1 ? 3 : 1;
    bool is_inner = true, meets_end = true;
    for (int axis = 0; axis < 3; ++axis) {
      double low = start[axis], high = start[axis];
      for (int a = 0; a < 3; ++a) {
        const double reach = (cell_edge - 1) * linear[axis][a];
        low += min_of(reach, 0.0);
        high += max_of(reach, 0.0);
      }
      const double last = source.dims[axis] - 1;
      const double slack = 0.51;  // nearest rounds up
      is_inner = is_inner && low > 0.01 && high < last - slack;
      meets_end = meets_end && high > last - slack - (axis == 0 ? spare : 0);
    }
    // Only at the last voxels of all would the read pass the end of the source.
    if (meets_end) return RowKind::alone;
    return is_inner ? RowKind::inner : RowKind::rim;
  }

  const TetSetup* setup_;
  int number_;
  RowKind kind_;
  SourceMap<float> map_;
  int corner_[3];
  std::int64_t ahead_ = 0;
};

/// Voxels of a row that one source serves.
struct RowRun {
  int source;     ///< position in the cell's sources
  unsigned bits;  ///< voxels
};

/// All covered voxels of a row.
struct RowRuns {
  int count = 0;
  RowRun run[cell_edge];
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
