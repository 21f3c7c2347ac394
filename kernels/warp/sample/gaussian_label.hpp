/// @file gaussian_label.hpp
/// Labels by Gaussian weights, as ITK's LabelImageGaussianInterpolateImageFunction chooses them.
#pragma once
#include <cmath>
#include <cstdint>

#include "kernels/base/any_number.hpp"
#include "kernels/warp/sample/label_shares.hpp"

namespace tetwarp {

/// A Gaussian around a position; a voxel's weight is its integral over the voxel's box.
struct GaussianWindow {
  static constexpr int max_voxels = 18;  ///< along an axis
  static constexpr double max_reach = 8;

  double sigma;  ///< standard deviation [voxel]
  double reach;  ///< voxels are read up to it from the position, at most max_reach [voxel]

  /// @param count    voxels of the source along the axis
  /// @param begin    out: first voxel
  /// @param weights  out, up to `max_voxels`
  /// @returns how many voxels there are, at least one
  TETWARP_HD int set_range(double x, int count, int& begin) const {
    const double first = min_of(max_of(floor(x + 0.5 - reach), 0.0), count - 1.0);
    const double past = max_of(min_of(ceil(x + 0.5 + reach), double(count)), first + 1);
    begin = static_cast<int>(first);
    return static_cast<int>(past - first);
  }
  TETWARP_HD void set_weights(double x, int begin, int count, double* weights) const {
    const double per_voxel = 1 / (sqrt(2.0) * sigma);
    double last = erf((begin - 0.5 - x) * per_voxel);
    for (int n = 0; n < count; ++n) {
      const double next = erf((begin + n + 0.5 - x) * per_voxel);
      weights[n] = next - last;
      last = next;
    }
  }
};

/// Chooses labels of a source.
struct GaussianLabels {
  NumberView source;  ///< labels of at most 32 bits, [k][j][i]
  int dims[3];
  GaussianWindow window;
  double background;

  /// The label with the largest sum of weights; the background at positions beyond the source.
  ///
  /// Sums that differ by at most 2^-40 of the Gaussian's integral are equal: of equal ones the
  /// lowest label wins, where ITK takes the one that it meets first.
  /// @param x  position [source voxel]
  TETWARP_HD_RARE double at(const double* x) const {
    int begin[3], size[3];
    for (int axis = 0; axis < 3; ++axis) {
      if (!(x[axis] >= -0.5 - slack && x[axis] <= dims[axis] - 0.5 + slack)) return background;
      size[axis] = window.set_range(x[axis], dims[axis], begin[axis]);
    }
    double label = background;
    with_numbers(source.data, source.kind,
                 [&](const auto* labels) { label = label_in(labels, x, begin, size); });
    return label;
  }

 private:
  static constexpr double slack = 0x1p-19;  ///< rounding of nodes, as in volume_sample.hpp

  template <class T>
  TETWARP_HD double label_in(const T* labels,
                             const double* x,
                             const int* begin,
                             const int* size) const {
    const auto row_at = [&](int j, int k) {
      const std::int64_t slice = std::int64_t{begin[2] + k} * dims[1] + begin[1] + j;
      return labels + slice * dims[0] + begin[0];
    };
    const T first = *row_at(0, 0);
    bool is_same = true;
    for (int k = 0; k < size[2] && is_same; ++k) {
      for (int j = 0; j < size[1]; ++j) {
        const T* const row = row_at(j, k);
        for (int i = 0; i < size[0]; ++i) is_same = is_same && row[i] == first;
      }
    }
    if (is_same) return static_cast<double>(first);
    double weight[3][GaussianWindow::max_voxels];
    for (int axis = 0; axis < 3; ++axis) {
      window.set_weights(x[axis], begin[axis], size[axis], weight[axis]);
    }
    constexpr double whole = 8;  // integral of the three erf, each from -1 to 1
    return label_of_largest_share(background, whole * 0x1p-40, [&](LabelShares& shares) {
      for (int k = 0; k < size[2]; ++k) {
        for (int j = 0; j < size[1]; ++j) {
          const T* const row = row_at(j, k);
          const double of_row = weight[1][j] * weight[2][k];
          for (int i = 0; i < size[0]; ++i) {
            shares.add(static_cast<double>(row[i]), weight[0][i] * of_row);
          }
        }
      }
    });
  }
};

}  // namespace tetwarp
