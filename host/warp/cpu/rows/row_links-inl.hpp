/// @file row_links-inl.hpp
/// Where transforms that follow each other take eight voxels of a row, in float64. Included once
/// per vector instruction set.
#if defined(TETWARP_ROW_LINKS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_LINKS_INL
#undef TETWARP_ROW_LINKS_INL
#else
#define TETWARP_ROW_LINKS_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/warp/row_resample.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Positions of eight voxels by axis.
struct alignas(64) EightPositions {
  double at[3][cell_edge];
};

/// Displacements of eight voxels by axis [world].
struct alignas(64) EightVectors {
  float at[3][cell_edge];
};

/// Coordinates of a grid's index space, split for interpolation.
struct alignas(64) EightIndices {
  double lower[3][cell_edge];
  double fraction[3][cell_edge];
  unsigned inside;  ///< bits of those within the grid; all are clamped to it
};

/// The links of a map, eight voxels at a time.
class RowLinks {
 public:
  /// @param map    of the job; must outlive the object
  explicit RowLinks(const ResampleMap& map) : map_(map) {}

  bool are_used() const { return map_.links.size > 0; }

  /// Whether they are one field, whose vectors() are all that is needed.
  bool are_field() const { return map_.links.size == 1 && map_.links[0].field.vectors != nullptr; }

  /// Begins row j of slice k of the output.
  void set_row(std::int64_t j, std::int64_t k) {
    const IndexAffine* const maps[] = {&map_.to_first, &map_.to_first_index, &map_.to_world,
                                       &map_.to_source};
    for (std::size_t n = 0; n < 4; ++n) {
      for (std::size_t row = 0; row < 3; ++row) {
        const double* const m = maps[n]->linear[row];
        step_[3 * n + row] = m[0];
        along_j_[3 * n + row] = m[1] * static_cast<double>(j);
        along_k_[3 * n + row] = m[2] * static_cast<double>(k);
        offset_[3 * n + row] = maps[n]->offset[row];
      }
    }
  }

  /// The displacements of eight voxels of the row from i on. @pre are_field()
  /// @returns the voxels that are not background, as bits
  unsigned vectors(std::int64_t i, EightVectors& vectors) const {
    const Tag d;
    double start[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {  // as IndexAffine::map()
      const std::size_t n = first_index + axis;
      start[axis] = step_[n] * static_cast<double>(i) + along_j_[n] + along_k_[n] + offset_[n];
    }
    EightIndices index;
    split(map_.links[0], index, [&](std::size_t lane, hn::Vec<Tag>* at) {
      const auto steps = hn::Iota(d, static_cast<double>(lane));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        at[axis] =
            hn::Add(hn::Set(d, start[axis]), hn::Mul(hn::Set(d, step_[first_index + axis]), steps));
      }
    });
    set_vectors(map_.links[0].field, index, vectors);
    return map_.only_in_field ? index.inside : 0xff;
  }

  /// Eight voxels of the row from i on.
  /// @param x  out, positions in the source's index space
  /// @returns the voxels that are not background, as bits
  unsigned positions(std::int64_t i, EightPositions& x) const {
    const Tag d;
    alignas(64) double start[padded_rows];
    for (std::size_t n = 0; n < padded_rows; n += hn::Lanes(d)) {  // as IndexAffine::map()
      auto sum = hn::Mul(hn::Load(d, step_ + n), hn::Set(d, static_cast<double>(i)));
      sum = hn::Add(hn::Add(sum, hn::Load(d, along_j_ + n)), hn::Load(d, along_k_ + n));
      hn::Store(hn::Add(sum, hn::Load(d, offset_ + n)), d, start + n);
    }
    const auto along_row = [&](std::size_t n, std::size_t lane) {
      const auto steps = hn::Iota(d, static_cast<double>(lane));
      return hn::Add(hn::Set(d, start[n]), hn::Mul(hn::Set(d, step_[n]), steps));
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
        hn::Store(along_row(first + axis, lane), d, x.at[axis] + lane);
      }
    }
    EightIndices index;
    split(map_.links[0], index, [&](std::size_t lane, hn::Vec<Tag>* at) {
      for (std::size_t axis = 0; axis < 3; ++axis) at[axis] = along_row(first_index + axis, lane);
    });
    unsigned inside = move_at(map_.links[0], index, x);
    for (std::int64_t n = 1; n < map_.links.size; ++n) inside &= move(map_.links[n], x);
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      hn::Vec<Tag> vector[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        vector[axis] = hn::Sub(hn::Load(d, x.at[axis] + lane), along_row(world + axis, lane));
      }
      for (std::size_t row = 0; row < 3; ++row) {
        const double* const m = map_.from_world[row];
        auto sum = along_row(source + row, lane);
        for (int c = 0; c < 3; ++c) sum = hn::Add(sum, hn::Mul(hn::Set(d, m[c]), vector[c]));
        hn::Store(sum, d, x.at[row] + lane);
      }
    }
    return map_.only_in_field ? inside : 0xff;
  }

  using Tag = hn::CappedTag<double, cell_edge>;

  /// A mask of points as bits.
  template <class Mask>
  static HWY_INLINE unsigned bits_of_mask(const Mask& mask) {
    const Tag d;
    if (HWY_LIKELY(hn::AllTrue(d, mask))) return (1u << hn::Lanes(d)) - 1;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    return bits[0];
  }

 private:
  /// Row `row` of map(x).
  static HWY_INLINE hn::Vec<Tag> mapped(const double* m, double offset, const hn::Vec<Tag>* x) {
    const Tag d;
    auto sum = hn::Set(d, offset);
    for (int c = 0; c < 3; ++c) sum = hn::Add(sum, hn::Mul(hn::Set(d, m[c]), x[c]));
    return sum;
  }

  /// TransformLink::move() of eight points. @returns those within its field or spline, as bits
  static unsigned move(const TransformLink& link, EightPositions& x) {
    const Tag d;
    if (!link.is_affine()) {
      EightIndices index;
      split(link, index, [&](std::size_t lane, hn::Vec<Tag>* at) {
        hn::Vec<Tag> from[3];
        for (int c = 0; c < 3; ++c) {
          from[c] = hn::Sub(hn::Load(d, x.at[c] + lane), hn::Set(d, link.to_index.origin[c]));
        }
        for (int row = 0; row < 3; ++row) at[row] = mapped(link.to_index.linear[row], 0, from);
      });
      return move_at(link, index, x);
    }
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      hn::Vec<Tag> from[3];
      for (int c = 0; c < 3; ++c) from[c] = hn::Load(d, x.at[c] + lane);
      for (int row = 0; row < 3; ++row) {
        hn::Store(mapped(link.affine.linear[row], link.affine.offset[row], from), d,
                  x.at[row] + lane);
      }
    }
    return 0xff;
  }

  /// Bounds of an index: those within which a grid has vectors, those to which it is clamped, and
  /// the largest lower neighbor.
  struct Bounds {
    double begin, end, low, high, last_lower;
  };

  static Bounds bounds_of(const TransformLink& link, int axis) {
    if (link.field.vectors != nullptr) {
      const double last = static_cast<double>(link.field.dims[axis] - 1);
      return {-0.5, last + 0.5, 0, last, last};
    }
    const double last = static_cast<double>(link.spline.dims[axis] - 2);
    constexpr double rounding = 1e-9;  // of positions on the rim, as in SplineView
    return {1 - rounding, last + rounding, 1, last, last - 1};
  }

  /// Splits the index positions of eight points.
  /// @param at  (lane, position): sets the coordinates of a vector of points
  template <class At>
  static HWY_INLINE void split(const TransformLink& link, EightIndices& index, const At& at) {
    const Tag d;
    const Bounds bounds[3] = {bounds_of(link, 0), bounds_of(link, 1), bounds_of(link, 2)};
    index.inside = 0;
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      hn::Vec<Tag> position[3];
      at(lane, position);
      auto are_inside = hn::Eq(hn::Zero(d), hn::Zero(d));
      for (int axis = 0; axis < 3; ++axis) {
        const Bounds& b = bounds[axis];
        auto x = position[axis];
        const auto is_inside =
            hn::And(hn::Ge(x, hn::Set(d, b.begin)), hn::Le(x, hn::Set(d, b.end)));
        are_inside = hn::And(are_inside, is_inside);
        x = hn::IfThenElse(is_inside, x, hn::Set(d, b.low));  // NaN is not inside
        x = hn::Min(hn::Max(x, hn::Set(d, b.low)), hn::Set(d, b.high));
        const auto lower = hn::Min(hn::Floor(x), hn::Set(d, b.last_lower));
        hn::Store(lower, d, index.lower[axis] + lane);
        hn::Store(hn::Sub(x, lower), d, index.fraction[axis] + lane);
      }
      index.inside |= bits_of_mask(are_inside) << lane;
    }
  }

  static unsigned move_at(const TransformLink& link, const EightIndices& index, EightPositions& x) {
    if (link.field.vectors != nullptr) {
      const Tag d;
      const hn::Rebind<float, Tag> df;
      EightVectors vectors;
      set_vectors(link.field, index, vectors);
      for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
          const auto vector = hn::PromoteTo(d, hn::Load(df, vectors.at[axis] + lane));
          hn::Store(hn::Add(hn::Load(d, x.at[axis] + lane), vector), d, x.at[axis] + lane);
        }
      }
      return index.inside;
    }
    for (int lane = 0; lane < cell_edge; ++lane) {
      if ((index.inside >> lane & 1) != 0) add_spline(link.spline, index, lane, x);
    }
    return index.inside;
  }

  /// The vectors of a field at eight points; zero at those beyond it.
  static void set_vectors(const FieldView& field,
                          const EightIndices& index,
                          EightVectors& vectors) {
    if (set_near(field, index, vectors)) return;
    for (int lane = 0; lane < cell_edge; ++lane) {
      alignas(16) float vector[4] = {};
      if ((index.inside >> lane & 1) != 0) set_vector(field, index, lane, vector);
      for (int axis = 0; axis < 3; ++axis) vectors.at[axis][lane] = vector[axis];
    }
  }

  /// The same of eight points within a field, if along each axis all or none lie between voxels;
  /// finite vectors with the bits of set_vector() of each.
  /// @returns false for other points
  static bool set_near(const FieldView& field, const EightIndices& index, EightVectors& vectors) {
    if (index.inside != 0xff) return false;
    const Tag d;
    const hn::Rebind<float, Tag> df;
    alignas(64) double place[cell_edge];
    alignas(64) float fraction[3][cell_edge];
    std::int64_t step[3], stride = 3;  // to the neighbor along an axis; 0: it is not read
    const auto everywhere = hn::Eq(hn::Zero(d), hn::Zero(d));
    for (int axis = 0; axis < 3; ++axis) {
      auto all = everywhere, none = everywhere;
      for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
        const auto f = hn::Load(d, index.fraction[axis] + lane);
        all = hn::And(all, hn::Gt(f, hn::Zero(d)));
        none = hn::And(none, hn::Eq(f, hn::Zero(d)));
        hn::Store(hn::DemoteTo(df, f), df, fraction[axis] + lane);
        const auto before = axis == 0 ? hn::Set(d, -3.0 * static_cast<double>(field.first))
                                      : hn::Load(d, place + lane);
        const auto along =
            hn::Mul(hn::Set(d, static_cast<double>(stride)), hn::Load(d, index.lower[axis] + lane));
        hn::Store(hn::Add(before, along), d, place + lane);
      }
      const bool is_between = hn::AllTrue(d, all);
      if (!is_between && !hn::AllTrue(d, none)) return false;
      step[axis] = is_between ? stride : 0;
      stride *= field.size[axis];
    }
    if ((step[0] | step[1] | step[2]) == 0 && set_row_vectors(field, place, vectors)) return true;
    // Four numbers are read from each neighbor on.
    const auto last = hn::Set(d, static_cast<double>(stride - 4 - step[0] - step[1] - step[2]));
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      if (!hn::AllTrue(d, hn::Le(hn::Load(d, place + lane), last))) return false;
    }
    alignas(64) float by_point[4 * cell_edge];
    interpolate(field, place, step, fraction, by_point);
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      hn::Vec<decltype(df)> vector[4];
      hn::LoadInterleaved4(df, by_point + 4 * lane, vector[0], vector[1], vector[2], vector[3]);
      for (int axis = 0; axis < 3; ++axis) hn::Store(vector[axis], df, vectors.at[axis] + lane);
    }
    return true;
  }

  /// Those of eight voxels that follow each other in a field.
  /// @param place  of the voxels, in numbers
  /// @returns false if they do not
  static bool set_row_vectors(const FieldView& field, const double* place, EightVectors& vectors) {
    const Tag d;
    const hn::Rebind<float, Tag> df;
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      const auto steps = hn::Iota(d, static_cast<double>(lane));
      const auto row = hn::Add(hn::Set(d, place[0]), hn::Mul(hn::Set(d, 3.0), steps));
      if (!hn::AllTrue(d, hn::Eq(hn::Load(d, place + lane), row))) return false;
    }
    const float* const first = field.vectors + static_cast<std::int64_t>(place[0]);
    for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(d)) {
      hn::Vec<decltype(df)> vector[3];
      hn::LoadInterleaved3(df, first + 3 * lane, vector[0], vector[1], vector[2]);
      for (int axis = 0; axis < 3; ++axis) hn::Store(vector[axis], df, vectors.at[axis] + lane);
    }
    return true;
  }

  /// The vectors of eight points: two at a time where vectors have eight lanes.
  /// @param place     of their lower neighbors, in numbers
  /// @param step      to the upper neighbors, in numbers
  /// @param fraction  along each axis
  /// @param vectors   out, four numbers each
  static void interpolate(const FieldView& field,
                          const double* place,
                          const std::int64_t* step,
                          const float (*fraction)[cell_edge],
                          float* vectors) {
    const PointTag d;
    const std::size_t points = hn::Lanes(d) / 4;
    const std::int64_t sx = step[0], sy = step[1], sz = step[2];
    // What the next row of the output reads, if the field is turned little: the processor does not
    // prefetch across this distance.
    const std::int64_t ahead = 3 * field.size[0];
    for (std::size_t lane = 0; lane < cell_edge; lane += 2) {
      const float* const v = field.vectors + static_cast<std::int64_t>(place[lane]);
      hwy::Prefetch(v + sy + ahead);
      hwy::Prefetch(v + sy + sz + ahead);
    }
    for (std::size_t lane = 0; lane < cell_edge; lane += points) {
      const auto of = [&](std::size_t n) {
        return field.vectors + static_cast<std::int64_t>(place[n]);
      };
      const float *const first = of(lane), *const second = of(lane + points - 1);
      const auto fx = of_fractions(d, fraction[0] + lane);
      const auto along_x = [&](std::int64_t at) {
        return lerp(fx, of_points(d, first + at, second + at),
                    of_points(d, first + at + sx, second + at + sx));
      };
      const auto fy = of_fractions(d, fraction[1] + lane);
      const auto near = lerp(fy, along_x(0), along_x(sy));
      const auto next = lerp(fy, along_x(sz), along_x(sz + sy));
      hn::Store(lerp(of_fractions(d, fraction[2] + lane), near, next), d, vectors + 4 * lane);
    }
  }

  /// Four numbers of one point or of two.
  using PointTag = hn::CappedTag<float, 8>;

  /// Of as many points as a vector holds, from `second` only if it holds two.
  template <class D>
  static HWY_INLINE hn::Vec<D> of_points(D d, const float* first, const float* second) {
    const hn::FixedTag<float, 4> point;
    if constexpr (hn::MaxLanes(D()) == 8) {
      return hn::Combine(d, hn::LoadU(point, second), hn::LoadU(point, first));
    } else {
      return hn::LoadU(d, first);
    }
  }

  /// The fraction of each point, four times.
  template <class D>
  static HWY_INLINE hn::Vec<D> of_fractions(D d, const float* fraction) {
    const hn::FixedTag<float, 4> point;
    if constexpr (hn::MaxLanes(D()) == 8) {
      return hn::Combine(d, hn::Set(point, fraction[1]), hn::Set(point, fraction[0]));
    } else {
      return hn::Set(d, fraction[0]);
    }
  }

  template <class V>
  static HWY_INLINE V lerp(V f, V a, V b) {
    return hn::Add(a, hn::Mul(f, hn::Sub(b, a)));
  }

  /// The vector of a field at a point: its three components at once.
  /// @param vector  out, four numbers, of which three are used
  static void set_vector(const FieldView& field,
                         const EightIndices& index,
                         int lane,
                         float* vector) {
    const hn::FixedTag<float, 4> d;
    std::int64_t lower[3], step[3], stride = 3;
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = static_cast<std::int64_t>(index.lower[axis][lane]);
      // A neighbor of weight zero is not read: it may not exist, or not be a number.
      step[axis] = index.fraction[axis][lane] > 0 ? stride : 0;
      stride *= field.size[axis];
    }
    const float* const v = field.at(lower[0], lower[1], lower[2]);
    const std::int64_t farthest = (v - field.vectors) + step[0] + step[1] + step[2];
    const bool is_last = farthest + 4 > stride;  // four numbers would end beyond the last vector
    const auto fx = hn::Set(d, static_cast<float>(index.fraction[0][lane]));
    const auto fy = hn::Set(d, static_cast<float>(index.fraction[1][lane]));
    const auto fz = hn::Set(d, static_cast<float>(index.fraction[2][lane]));
    const auto load = [&](const float* from) {
      if (!is_last) return hn::LoadU(d, from);
      alignas(16) const float numbers[4] = {from[0], from[1], from[2], 0};
      return hn::Load(d, numbers);
    };
    const auto along_x = [&](const float* from) {
      return lerp(fx, load(from), load(from + step[0]));
    };
    const auto near = lerp(fy, along_x(v), along_x(v + step[1]));
    const auto next = lerp(fy, along_x(v + step[2]), along_x(v + step[2] + step[1]));
    hn::Store(lerp(fz, near, next), d, vector);
  }

  /// Adds the vector of a spline to a point: rows of four coefficients at once.
  static void add_spline(const SplineView& spline,
                         const EightIndices& index,
                         int lane,
                         EightPositions& x) {
    std::int64_t first[3];
    double weights[3][4];
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = static_cast<std::int64_t>(index.lower[axis][lane]) - 1;
      set_cubic_weights(index.fraction[axis][lane], weights[axis]);
    }
    double sums[12] = {};  // of the components of four neighbors along x
    for (int c = 0; c < 4; ++c) {
      for (int b = 0; b < 4; ++b) {
        const std::int64_t row = (first[2] + c) * spline.dims[1] + first[1] + b;
        const double* const v = spline.coefficients + 3 * (row * spline.dims[0] + first[0]);
        const double weight = weights[2][c] * weights[1][b];
        for (int n = 0; n < 12; ++n) sums[n] += weight * v[n];
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (int a = 0; a < 4; ++a) x.at[axis][lane] += weights[0][a] * sums[3 * a + axis];
    }
  }

  // Rows of four maps, three each, and padding.
  static constexpr std::size_t first = 0, first_index = 3, world = 6, source = 9, padded_rows = 16;

  const ResampleMap& map_;
  // Of the rows of to_first, to_first_index, to_world and to_source: their first coefficients, what
  // j and k add, and their offsets.
  alignas(64) double step_[padded_rows] = {};
  alignas(64) double along_j_[padded_rows] = {};
  alignas(64) double along_k_[padded_rows] = {};
  alignas(64) double offset_[padded_rows] = {};
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
