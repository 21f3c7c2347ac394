/// @file row_field-inl.hpp
/// Displacements of the voxels of a row by a field whose grid is parallel to the output's. Included
/// once per vector instruction set.
#if defined(TETWARP_ROW_FIELD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_FIELD_INL
#undef TETWARP_ROW_FIELD_INL
#else
#define TETWARP_ROW_FIELD_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "kernels/base/view.hpp"
#include "kernels/warp/row_resample.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Interpolates a field along whole rows: between its rows once for all voxels, then along the row,
/// where places and weights are the same in all rows.
class RowField {
 public:
  /// @param map   of the job; must outlive the object
  /// @param row_voxels  of a row of the output
  RowField(const ResampleMap& map, std::int64_t row_voxels) {
    if (!map.is_parallel) return;
    field_ = &map.links[0].field;
    to_index_ = &map.to_first_index;
    outside_bits_ = map.only_in_field ? 0 : 0xff;
    places_.resize(static_cast<std::size_t>(row_voxels));
    inside_bits_.resize(places_.size());
    for (std::size_t i = 0; i < places_.size(); ++i) {
      places_[i] = place_at(0, static_cast<double>(i));
      if (!places_[i].is_inside) continue;
      first_ = std::min(first_, places_[i].lower);
      past_ = std::max(past_, places_[i].upper + 1);
      for (std::size_t lane = 0; lane < std::min<std::size_t>(cell_edge, i + 1); ++lane) {
        inside_bits_[i - lane] |= static_cast<std::uint8_t>(1u << lane);
      }
    }
    blended_.resize(static_cast<std::size_t>(3 * std::max<std::int64_t>(past_ - first_, 0) + 1));
    vectors_.resize(3 * places_.size() + 1);
  }

  /// Whether the field is one that is interpolated here.
  bool is_used() const { return field_ != nullptr; }

  /// Interpolates row j of slice k of the output.
  void set_row(std::int64_t j, std::int64_t k) {
    const Place y = place_at(1, static_cast<double>(j)), z = place_at(2, static_cast<double>(k));
    is_inside_ = past_ > first_ && y.is_inside && z.is_inside;
    if (!is_inside_) {
      std::ranges::fill(vectors_, 0.0f);
      return;
    }
    blend(y, z);
    const hn::FixedTag<float, 4> d;
    // A vector of four numbers ends in the next voxel, which is written after it.
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Place& x = places_[i];
      float* const to = vectors_.data() + 3 * i;
      if (!x.is_inside) {
        hn::StoreU(hn::Zero(d), d, to);
        continue;
      }
      const auto lower = hn::LoadU(d, blended_.data() + 3 * (x.lower - first_));
      const auto upper = hn::LoadU(d, blended_.data() + 3 * (x.upper - first_));
      const auto weight = hn::Set(d, x.fraction);
      hn::StoreU(hn::Add(lower, hn::Mul(weight, hn::Sub(upper, lower))), d, to);
    }
  }

  /// Of voxel i of the row on, three numbers each [world].
  const float* vectors(std::int64_t i) const { return vectors_.data() + 3 * i; }

  /// Those of eight voxels from i on that are not background, as bits.
  unsigned inside(std::int64_t i) const {
    return outside_bits_ | (is_inside_ ? inside_bits_[static_cast<std::size_t>(i)] : 0u);
  }

 private:
  /// Neighbors of a position along an axis of the field's grid; the upper one is the lower one
  /// where its weight is zero: it may not exist, or not be a number.
  struct Place {
    std::int64_t lower = 0, upper = 0;
    float fraction = 0;
    bool is_inside = false;
  };

  Place place_at(int axis, double voxel) const {
    const double index = to_index_->linear[axis][axis] * voxel + to_index_->offset[axis];
    const double last = static_cast<double>(field_->dims[axis] - 1);
    Place place;
    place.is_inside = index >= -0.5 && index <= last + 0.5;
    if (!place.is_inside) return place;
    const double near = std::min(std::max(index, 0.0), last);
    place.lower = static_cast<std::int64_t>(near);
    place.fraction = static_cast<float>(near - static_cast<double>(place.lower));
    place.upper = place.lower + (place.fraction > 0 ? 1 : 0);
    return place;
  }

  /// Interpolates what the row reads of the field across the row.
  void blend(const Place& y, const Place& z) {
    const float* const near[2] = {field_->at(first_, y.lower, z.lower),
                                  field_->at(first_, y.upper, z.lower)};
    const float* const next[2] = {field_->at(first_, y.lower, z.upper),
                                  field_->at(first_, y.upper, z.upper)};
    const hn::ScalableTag<float> d;
    const auto fy = hn::Set(d, y.fraction), fz = hn::Set(d, z.fraction);
    const auto lerp = [](auto f, auto a, auto b) { return hn::Add(a, hn::Mul(f, hn::Sub(b, a))); };
    const std::size_t count = blended_.size() - 1, lanes = hn::Lanes(d);
    std::size_t n = 0;
    for (; n + lanes <= count; n += lanes) {
      const auto load = [&](const float* from) { return hn::LoadU(d, from + n); };
      const auto low = lerp(fy, load(near[0]), load(near[1]));
      const auto high = lerp(fy, load(next[0]), load(next[1]));
      hn::StoreU(lerp(fz, low, high), d, blended_.data() + n);
    }
    for (; n < count; ++n) {
      const float low = near[0][n] + y.fraction * (near[1][n] - near[0][n]);
      const float high = next[0][n] + y.fraction * (next[1][n] - next[0][n]);
      blended_[n] = low + z.fraction * (high - low);
    }
  }

  const FieldView* field_ = nullptr;
  const IndexAffine* to_index_ = nullptr;
  unsigned outside_bits_ = 0xff;           ///< of voxels beyond the field
  std::vector<Place> places_;              ///< of the voxels of a row
  std::vector<std::uint8_t> inside_bits_;  ///< of eight from each on, along the row
  bool is_inside_ = false;                 ///< the row may be within the field
  std::int64_t first_ = std::numeric_limits<std::int64_t>::max(), past_ = 0;  ///< that rows read
  std::vector<float> blended_, vectors_;  ///< with one number more, which loads and stores touch
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
