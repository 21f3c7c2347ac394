/// @file volume_label.hpp
/// The filter for labels: the label of largest total weight among the eight neighbors that linear
/// interpolation would read.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/warp/sample/volume_filter.hpp"
#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {

/// Fractions are rounded to multiples of its inverse [voxel]. Trilinear weights are then integers
/// whose sum is its cube, so sums and ties are exact on every processor.
constexpr double label_steps = 0x1p20;

/// The label with the largest sum of trilinear weights; of equal ones the lowest.
/// @param label     labels of the eight neighbors, x fastest
/// @param fraction  of the way from the lower to the upper neighbors, per axis
template <class T, class Real>
TETWARP_HD T heaviest_label(const T* label, const Real* fraction) {
  std::int64_t weight[3][2], share[8];
  for (int axis = 0; axis < 3; ++axis) {
    weight[axis][1] = static_cast<std::int64_t>(rint(fraction[axis] * Real(label_steps)));
    weight[axis][0] = static_cast<std::int64_t>(label_steps) - weight[axis][1];
  }
  for (int corner = 0; corner < 8; ++corner) {
    share[corner] = weight[0][corner & 1] * weight[1][corner >> 1 & 1] * weight[2][corner >> 2];
  }
  constexpr std::int64_t half = std::int64_t{1} << 59;  // half of the sum of all weights
  std::int64_t most = 0;
  T winner = label[0];
  for (int corner = 0; corner < 8 && most <= half; ++corner) {
    std::int64_t sum = 0;
    for (int other = 0; other < 8; ++other) {
      sum += label[other] == label[corner] ? share[other] : 0;
    }
    if (sum > most || (sum == most && label[corner] < winner)) {
      most = sum;
      winner = label[corner];
    }
  }
  return winner;
}

/// The label at a position. Equals interpolating the indicator function of each label linearly and
/// taking the label of the largest value, without making these volumes.
/// @pre the source has one component
template <class T>
TETWARP_HD T label_at(const SourceView<T>& source, const SourcePosition<ArithmeticOf<T>>& at) {
  std::int64_t offset[3][2], stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const int last = source.dims[axis] - 1;
    offset[axis][0] = min_of(max_of(at.voxel[axis], 0), last) * stride;
    offset[axis][1] = min_of(max_of(at.voxel[axis] + 1, 0), last) * stride;
    stride *= source.dims[axis];
  }
  T label[8];
  bool is_same = true;
  for (int corner = 0; corner < 8; ++corner) {
    label[corner] =
        source.data[offset[0][corner & 1] + offset[1][corner >> 1 & 1] + offset[2][corner >> 2]];
    is_same = is_same && label[corner] == label[0];
  }
  return is_same ? label[0] : heaviest_label(label, at.fraction);
}

}  // namespace tetwarp
