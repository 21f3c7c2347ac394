/// @file row_scalar.cpp
/// Filters work in vectors of four float32 lanes, which every supported processor has: one lane per
/// axis for positions and weights, then one per tap along x.
#include "host/warp/cpu/rows/row_scalar.hpp"

#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <type_traits>

#include "host/base/pixel_dispatch.hpp"
#include "kernels/warp/voxel_transform.hpp"

namespace tetwarp {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using LaneTag = hn::FixedTag<float, 4>;
using LaneIntTag = hn::RebindToSigned<LaneTag>;

/// Four float32 numbers as a number type for the templates of volume_filter.hpp.
struct Lanes {
  hn::Vec<LaneTag> v;

  Lanes() = default;
  explicit Lanes(double all) : v(hn::Set(LaneTag(), static_cast<float>(all))) {}
  explicit Lanes(hn::Vec<LaneTag> lanes) : v(lanes) {}

  friend Lanes operator+(Lanes a, Lanes b) { return Lanes(hn::Add(a.v, b.v)); }
  friend Lanes operator-(Lanes a, Lanes b) { return Lanes(hn::Sub(a.v, b.v)); }
  friend Lanes operator*(Lanes a, Lanes b) { return Lanes(hn::Mul(a.v, b.v)); }
  friend Lanes operator/(Lanes a, Lanes b) { return Lanes(hn::Div(a.v, b.v)); }
};

/// Four successive samples.
template <class T>
Lanes read_four(const T* samples) {
  const LaneTag d;
  if constexpr (std::is_same_v<T, float>) {
    return Lanes(hn::LoadU(d, samples));
  } else {
    const auto narrow = hn::LoadU(hn::Rebind<T, LaneTag>(), samples);
    return Lanes(hn::ConvertTo(d, hn::PromoteTo(LaneIntTag(), narrow)));
  }
}

/// Positions of the voxels of a row, one lane per axis; the fourth lane is not used.
class RowWalk {
 public:
  /// @param around  number of samples that the filter reads on either side of a position
  template <class T>
  RowWalk(const SourceView<T>& source, const RowMap& map, int around, int j, int k) {
    const LaneTag d;
    const auto row = hn::Mul(hn::Load(d, map.axis[1]), hn::Set(d, static_cast<float>(j)));
    const auto slice = hn::Mul(hn::Load(d, map.axis[2]), hn::Set(d, static_cast<float>(k)));
    start_ = hn::Add(hn::Add(hn::Load(d, map.base), row), slice);
    step_ = hn::Load(d, map.axis[0]);
    whole_ = hn::Load(LaneIntTag(), map.whole);
    first_ = hn::Set(LaneIntTag(), around - 1);
    const std::int32_t last[4] = {source.dims[0] - 1 - around, source.dims[1] - 1 - around,
                                  source.dims[2] - 1 - around, 0};
    last_ = hn::LoadU(LaneIntTag(), last);
  }

  /// Moves to voxel i. @returns whether all samples around it exist and all have a weight
  bool move_to(int i) {
    const LaneTag d;
    const LaneIntTag di;
    constexpr float least = 0x1p-20f;
    const auto x = hn::Add(start_, hn::Mul(step_, hn::Set(d, static_cast<float>(i))));
    const auto lower = hn::Floor(x);
    const auto t = hn::Sub(x, lower);
    const auto at = hn::Add(whole_, hn::ConvertTo(di, lower));
    fraction = Lanes(t);
    hn::Store(t, d, fractions);
    hn::Store(at, di, voxel);
    const auto within = hn::And(hn::Ge(t, hn::Set(d, least)), hn::Le(t, hn::Set(d, 1 - least)));
    const auto beyond = hn::Or(hn::Lt(at, first_), hn::Gt(at, last_));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::AndNot(hn::RebindMask(d, beyond), within), bits);
    return (bits[0] & 7) == 7;
  }

  Lanes fraction;
  alignas(16) float fractions[4];
  alignas(16) std::int32_t voxel[4];  ///< lower neighbor

 private:
  hn::Vec<LaneTag> start_, step_;
  hn::Vec<LaneIntTag> whole_, first_, last_;
};

/// blended() of volume_filter.hpp for four or six taps that all exist, with equal bits.
/// @param samples  at the lower neighbor
template <Filter filter, class Sample>
float blended_lanes(const Sample* samples,
                    std::ptrdiff_t up,
                    std::ptrdiff_t far,
                    const RowWalk& at) {
  constexpr int taps = filter == Filter::lanczos ? 6 : 4;
  const LaneTag d;
  Lanes weights[taps];
  filter_weights(filter, at.fraction, weights);
  alignas(16) float weight[taps][4];
  for (int i = 0; i < taps; ++i) hn::Store(weights[i].v, d, weight[i]);
  const auto step_to_near = [&](int axis) { return at.fractions[axis] < 0.5f ? 0 : 1; };
  const float near =
      static_cast<float>(samples[step_to_near(0) + step_to_near(1) * up + step_to_near(2) * far]);
  const Lanes nears(static_cast<double>(near));
  const Sample* first = samples - (taps / 2 - 1) * (1 + up + far);
  Lanes along_y[taps];
  for (int i = 0; i < taps; ++i) along_y[i] = Lanes(static_cast<double>(weight[i][1]));
  // Of six taps a second vector holds the last four; only its last two lanes are used.
  Lanes column(0.0), column_end(0.0);
  for (int z = 0; z < taps; ++z, first += far) {
    Lanes part(0.0), part_end(0.0);
    const Sample* line = first;
    for (int y = 0; y < taps; ++y, line += up) {
      part = part + along_y[y] * (read_four(line) - nears);
      if constexpr (taps == 6) part_end = part_end + along_y[y] * (read_four(line + 2) - nears);
    }
    const Lanes w(static_cast<double>(weight[z][2]));
    column = column + w * part;
    if constexpr (taps == 6) column_end = column_end + w * part_end;
  }
  alignas(16) float columns[8];
  hn::StoreU(column_end.v, d, columns + 2);
  hn::StoreU(column.v, d, columns);
  float sum = 0;
  for (int x = 0; x < taps; ++x) sum += weight[x][0] * columns[x];
  return near + sum;
}

/// The sample of one voxel whose neighbors all exist; one component, not labels.
template <class T>
T sample_lanes(const SourceView<T>& source, Filter filter, const RowWalk& at) {
  const std::ptrdiff_t up = source.dims[0], far = up * source.dims[1];
  const std::ptrdiff_t offset = at.voxel[0] + at.voxel[1] * up + at.voxel[2] * far;
  const T* const samples = source.data + offset;
  float value = 0;
  if (filter == Filter::lanczos) {
    value = blended_lanes<Filter::lanczos>(samples, up, far, at);
  } else if (filter == Filter::cubic) {
    value = blended_lanes<Filter::cubic>(samples, up, far, at);
  } else {
    value = blended_lanes<Filter::bspline>(source.coefficients + offset, up, far, at);
  }
  return finished(source, value, 0);
}

/// Samples and stores voxel (i, j, k), with any number of components.
template <class Real, class T>
void sample_one(
    const RasterJob<T>& job, const SourceMap<Real>& map, int i, int j, int k, std::int64_t row) {
  Real x[3];
  local_position(map, i, j, k, x);
  store_wide_sample(job, job.filter, map.whole, x, job.volume + (row + i) * job.source.components);
}

/// Calls store(i) for the voxels `bits`.
template <class Store>
void for_voxels(unsigned bits, const Store& store) {
  for (; bits != 0; bits &= bits - 1) store(std::countr_zero(bits));
}

/// Writes the voxels `bits` of row (j, k), with the results of store_sample().
template <class T>
void write_filtered(
    const RasterJob<T>& job, const RowMap& row_map, unsigned bits, int j, int k, std::int64_t row) {
  double start[3], linear[3][3];
  const auto set_start = [&] { map_start(row_map.setup, row_map.corner, start, linear); };
  if constexpr (sizeof(ArithmeticOf<T>) == 4) {
    if (!is_wide(job.filter)) {
      set_start();
      const auto map = make_source_map<float>(job.source, start, linear);
      for_voxels(bits, [&](int i) {
        store_sample<false>(job, job.filter, map, {row_map.corner, i, j, k, row + i});
      });
      return;
    }
    if (row_map.setup.kind == MapKind::affine) {
      RowWalk walk(job.source, row_map, reach_of(job.filter), j, k);
      for_voxels(bits, [&](int i) {
        if (job.source.components == 1 && job.filter != Filter::labels && walk.move_to(i)) {
          job.volume[row + i] = sample_lanes(job.source, job.filter, walk);
        } else {
          set_start();
          sample_one(job, make_source_map<float>(job.source, start, linear), i, j, k, row);
        }
      });
      return;
    }
  }
  set_start();
  const auto map = make_source_map<double>(job.source, start, linear);
  for_voxels(bits, [&](int i) { sample_one(job, map, i, j, k, row); });
}

/// write_scalar_run() of one pixel type.
template <class T>
void write_run(
    const RasterJob<T>& job, const RowMap& map, unsigned bits, int j, int k, std::int64_t row) {
  if (has_transform(job, map.tet)) {
    for_voxels(bits, [&](int i) {
      store_transformed_voxel(job, map.tet, {map.corner, i, j, k, row + i});
    });
  } else if (map.setup.kind == MapKind::trilinear) {
    const HexMap hex = hex_map_of(job, map.tet);
    for_voxels(bits, [&](int i) {
      const int x[3] = {map.corner[0] + i, map.corner[1] + j, map.corner[2] + k};
      store_hex_voxel<true>(job, hex, x, row + i);
    });
  } else {
    write_filtered(job, map, bits, j, k, row);
  }
}
}  // namespace

void write_scalar_run(PixelType type,
                      const RasterGeometry& job,
                      const RowMap& map,
                      unsigned bits,
                      int j,
                      int k,
                      std::int64_t row) {
  with_pixel_type(type, [&]<class T>(T) {
    write_run(static_cast<const RasterJob<T>&>(job), map, bits, j, k, row);
  });
}

void write_scalar_outside(
    PixelType type, const RasterGeometry& job, const int* first, int begin, int end, int j, int k) {
  with_pixel_type(type, [&]<class T>(T) {
    const auto& typed = static_cast<const RasterJob<T>&>(job);
    for (int voxel = begin; voxel < end; ++voxel) {
      const int i = voxel % cell_edge;
      const int corner[3] = {first[0] + voxel - i, first[1], first[2]};
      if (has_outside_transform(job)) {
        store_transformed_outside(typed, {corner, i, j, k, voxel});
      } else {
        store_outside<true>(typed, {corner, i, j, k, voxel});
      }
    }
  });
}

}  // namespace tetwarp
