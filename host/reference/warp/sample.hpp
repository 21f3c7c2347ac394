/// @file sample.hpp
/// Interpolation in the reference: every filter in float64, from the definitions.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <type_traits>
#include <vector>

#include <tetwarp/warp.hpp>

#include "host/reference/warp/exact_geometry.hpp"

namespace tetwarp::reference {

/// Weight of a sample at a distance along one axis [voxel]; the weights of a position need not sum
/// to one.
double weight_of(Filter filter, double distance);

/// Distance beyond which weight_of() is zero [voxel].
int radius_of(Filter filter);

/// Index of the sample to use at index i, which may be outside of [0, n): the nearest, for splines
/// the mirrored one.
std::int64_t stand_in(Filter filter, std::int64_t i, std::int64_t n);

/// Coefficients of the cubic B-spline through samples [k][j][i][component], mirrored at the
/// boundary. A sample that is not finite is replaced by the one before it in its row, at the
/// beginning of a row by the next finite one.
std::vector<double> spline_coefficients(std::vector<double> samples,
                                        const std::array<std::int64_t, 3>& dims,
                                        int components);

/// A value rounded to T and limited to its range.
template <class T>
T stored(double value) {
  if constexpr (std::is_integral_v<T>) {
    const double whole = std::nearbyint(value);
    if (whole <= static_cast<double>(std::numeric_limits<T>::min())) {
      return std::numeric_limits<T>::min();
    }
    if (whole >= static_cast<double>(std::numeric_limits<T>::max())) {
      return std::numeric_limits<T>::max();
    }
    return static_cast<T>(whole);
  }
  return static_cast<T>(value);
}

template <class T>
class Sampler {
 public:
  /// @param held   voxels of the source grid that source.data holds
  /// @param range  least and largest sample of each component in turn; null: computed when needed
  Sampler(const VolumeView& source,
          const Region& held,
          const WarpOptions& options,
          const std::vector<double>* range)
      : data_(static_cast<const T*>(source.data)),
        n_(source.grid.dims),
        held_(held),
        components_(source.components),
        filter_(options.filter),
        rule_(options.label_rule),
        gaussian_(options.label_gaussian),
        background_(stored<T>(options.background)),
        low_(static_cast<std::size_t>(components_), -INFINITY),
        high_(static_cast<std::size_t>(components_), INFINITY) {
    const auto count = static_cast<std::size_t>(source.grid.voxel_count() * components_);
    if (filter_ == Filter::bspline) {
      coefficients_ = spline_coefficients({data_, data_ + count}, n_, components_);
      for (std::size_t s = 0; s < count; ++s) {
        if (!std::isfinite(static_cast<double>(data_[s]))) coefficients_[s] = double(data_[s]);
      }
    }
    const bool blends = filter_ != Filter::nearest && filter_ != Filter::labels;
    if (!blends || options.overshoot == Overshoot::keep) return;
    for (std::size_t c = 0; range != nullptr && c < low_.size(); ++c) {
      low_[c] = (*range)[2 * c];
      high_[c] = (*range)[2 * c + 1];
    }
    if (range != nullptr) return;
    std::ranges::fill(low_, INFINITY);
    std::ranges::fill(high_, -INFINITY);
    for (std::size_t s = 0; s < count; ++s) {
      const double sample = static_cast<double>(data_[s]);
      const std::size_t c = s % low_.size();
      if (sample < low_[c]) low_[c] = sample;
      if (sample > high_[c]) high_[c] = sample;
    }
  }

  T background() const { return background_; }
  int components() const { return components_; }

  /// Writes the values at an index position, rounded to T, or the background outside of the source.
  void store(const Eigen::Vector3d& x, T* out) const {
    bool is_center = true;
    for (int axis = 0; axis < 3; ++axis) {
      const auto n = static_cast<double>(n_[static_cast<std::size_t>(axis)]);
      if (!(x(axis) >= -0.5 - rim && x(axis) <= n - 0.5 + rim)) {
        std::fill_n(out, components_, background_);
        return;
      }
      is_center = is_center && x(axis) == std::floor(x(axis));
    }
    if (rule_ == LabelRule::gaussian) {
      out[0] = gaussian_label_at(x);
      return;
    }
    for (int c = 0; c < components_; ++c) {
      if (is_center || filter_ == Filter::nearest) {
        out[c] = data_[offset_of({std::floor(x(0) + 0.5), std::floor(x(1) + 0.5),
                                  std::floor(x(2) + 0.5)}) +
                       c];
      } else if (filter_ == Filter::labels) {
        out[c] = label_at(x);
      } else {
        const double value = value_at(x, c);
        const auto of = static_cast<std::size_t>(c);
        out[c] = stored<T>(value < low_[of] ? low_[of] : value > high_[of] ? high_[of] : value);
      }
    }
  }

  /// Adds the values at an index position, not rounded. @returns false outside of the source, where
  /// nothing is added
  bool add(const Eigen::Vector3d& x, Eigen::VectorXd& sums) const {
    for (int axis = 0; axis < 3; ++axis) {
      const auto n = static_cast<double>(n_[static_cast<std::size_t>(axis)]);
      if (!(x(axis) >= -0.5 - rim && x(axis) <= n - 0.5 + rim)) return false;
    }
    const Eigen::Vector3d nearest = (x.array() + 0.5).floor();
    const bool is_sample = x == nearest || filter_ == Filter::nearest;
    for (int c = 0; c < components_; ++c) {
      sums(c) += is_sample ? static_cast<double>(data_[offset_of(nearest) + c]) : value_at(x, c);
    }
    return true;
  }

  /// Limits values to the range of the samples with Overshoot::clamp.
  void clamp(Eigen::VectorXd& values) const {
    for (int c = 0; c < components_; ++c) {
      const auto of = static_cast<std::size_t>(c);
      if (values(c) < low_[of]) values(c) = low_[of];
      if (values(c) > high_[of]) values(c) = high_[of];
    }
  }

 private:
  /// Position in memory of component 0 of the voxel to use at (i, j, k), see stand_in().
  std::int64_t offset_of(const Eigen::Vector3d& ijk) const {
    std::int64_t offset = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
      const auto i = static_cast<std::int64_t>(ijk(static_cast<Eigen::Index>(axis)));
      offset = offset * (held_.end[axis] - held_.begin[axis]) +
               (stand_in(filter_, i, n_[axis]) - held_.begin[axis]);
    }
    return offset * components_;
  }

  /// Calls visit(offset, weight) for all samples with a weight at x.
  template <class Visit>
  void for_neighbors(const Eigen::Vector3d& x, const Visit& visit) const {
    const int radius = radius_of(filter_);
    const Eigen::Vector3d first = x.array().floor() - (radius - 1);
    for (int k = 0; k < 2 * radius; ++k) {
      for (int j = 0; j < 2 * radius; ++j) {
        for (int i = 0; i < 2 * radius; ++i) {
          const Eigen::Vector3d at = first + Eigen::Vector3d(i, j, k);
          const double weight = weight_of(filter_, x(0) - at(0)) *
                                weight_of(filter_, x(1) - at(1)) * weight_of(filter_, x(2) - at(2));
          if (weight != 0) visit(offset_of(at), weight);
        }
      }
    }
  }

  double value_at(const Eigen::Vector3d& x, int component) const {
    double sum = 0, weights = 0;
    for_neighbors(x, [&](std::int64_t offset, double weight) {
      const std::int64_t s = offset + component;
      const double sample = coefficients_.empty() ? static_cast<double>(data_[s])
                                                  : coefficients_[static_cast<std::size_t>(s)];
      sum += weight * sample;
      weights += weight;
    });
    return sum / weights;
  }

  /// Positions are rounded to 2^-20 voxel, so that ties do not depend on rounding errors.
  T label_at(const Eigen::Vector3d& x) const {
    std::map<T, double> shares;
    const Eigen::Vector3d rounded = (x * one_voxel).array().rint() / one_voxel;
    for_neighbors(rounded,
                  [&](std::int64_t offset, double weight) { shares[data_[offset]] += weight; });
    const auto smaller = [](const auto& a, const auto& b) { return a.second < b.second; };
    return std::ranges::max_element(shares, smaller)->first;
  }

  /// The label with the largest integral of a Gaussian over its voxels within the cutoff.
  T gaussian_label_at(const Eigen::Vector3d& x) const {
    const double reach = gaussian_.sigma * gaussian_.cutoff;
    const auto is_near = [&](int axis, double voxel) {
      return std::abs(voxel - x(axis)) < reach + 0.5;
    };
    const auto weight = [&](int axis, double voxel) {
      const double scale = gaussian_.sigma * std::sqrt(2.0);
      return std::erf((voxel + 0.5 - x(axis)) / scale) - std::erf((voxel - 0.5 - x(axis)) / scale);
    };
    std::map<double, double> sums;
    for (double k = 0; k < static_cast<double>(n_[2]); ++k) {
      if (!is_near(2, k)) continue;
      for (double j = 0; j < static_cast<double>(n_[1]); ++j) {
        if (!is_near(1, j)) continue;
        for (double i = 0; i < static_cast<double>(n_[0]); ++i) {
          if (!is_near(0, i)) continue;
          sums[static_cast<double>(data_[offset_of({i, j, k})])] +=
              weight(0, i) * weight(1, j) * weight(2, k);
        }
      }
    }
    T winner = background_;
    double most = -1;  // below all sums, so that the lowest label replaces the background
    for (const auto& [label, sum] : sums) {
      if (sum <= most + 8 * 0x1p-40) continue;
      most = sum;
      winner = static_cast<T>(label);
    }
    return winner;
  }

  const T* data_;
  std::array<std::int64_t, 3> n_;
  Region held_;  ///< voxels of the source grid that `data_` holds
  int components_;
  Filter filter_;
  LabelRule rule_;
  LabelGaussian gaussian_;
  T background_;
  std::vector<double> coefficients_;  ///< of splines; empty for other filters
  std::vector<double> low_, high_;    ///< limits of values, per component
};

}  // namespace tetwarp::reference
