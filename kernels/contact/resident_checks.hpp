/// @file resident_checks.hpp
/// Checks of a problem whose arrays are in memory of the executor. They only decide whether the
/// checks of the host would pass: if not, the host copies the arrays and repeats its checks for the
/// message. So their limits are stricter, see CheckLimit.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"
#include "kernels/contact/check_limits.hpp"
#include "kernels/contact/contact_fill.hpp"
#include "kernels/contact/contact_indices.hpp"

namespace tetwarp {

/// A count that a reduction adds.
using BadCount = PlainSums<1>;

/// Rows of a sparse matrix, without its numbers.
struct RowsView {
  View<const std::int64_t> row_start;
  View<const std::int32_t> column;
};

/// The largest of several numbers, as a reduction.
template <int count>
struct LargestOf {
  double value[count] = {};

  TETWARP_HD LargestOf& operator+=(const LargestOf& other) {
    for (int k = 0; k < count; ++k) value[k] = max_of(value[k], other.value[k]);
    return *this;
  }
};

/// One index = one number of several arrays: 1 where it is not finite or out of its range.
struct RangeCheckOp {
  static constexpr int most = 11;
  struct Entry {
    View<const double> values;
    double low, high;
  };
  Entry arrays[most];
  int count = 0;
  std::int64_t total = 0;

  void add(View<const double> values, double low, double high) {
    if (values.size == 0) return;
    arrays[count++] = {values, low, high};
    total += values.size;
  }

  TETWARP_HD BadCount operator()(std::int64_t i) const {
    int k = 0;
    for (; i >= arrays[k].values.size; ++k) i -= arrays[k].values.size;
    const double value = arrays[k].values[i];
    const bool is_good = value >= arrays[k].low && value <= arrays[k].high;  // false for NaN
    return {{is_good ? 0.0 : 1.0}};
  }
};

/// Whether a stored number of A was zero when the structure was made; `either`: the structure is
/// the same in both cases.
enum class Zero : std::uint8_t { no, yes, either };

/// One index = one stored number of A: 1 where it has become zero or nonzero since the structure
/// was made, and blocks or couplings depend on it.
struct ZeroPatternOp {
  View<const double> system;
  View<const Zero> is_zero;

  TETWARP_HD BadCount operator()(std::int64_t e) const {
    const Zero now = system[e] == 0 ? Zero::yes : Zero::no;
    return {{is_zero[e] == Zero::either || is_zero[e] == now ? 0.0 : 1.0}};
  }
};

/// One index = one contact: scales of the checks below. [0]: largest |J|, or largest diagonal entry
/// of W; [1]: largest of |gap_n| and |dt w_n| [m].
struct ContactScalesOp {
  ContactInput in;
  RowsView rows;  ///< of J, or of W

  TETWARP_HD double size_of_row(std::int64_t row, bool is_local) const {
    double size = 0;
    for (std::int64_t e = rows.row_start[row]; e < rows.row_start[row + 1]; ++e) {
      if (is_local) {
        if (rows.column[e] == row) size += in.matrix[e];
      } else {
        size = max_of(size, fabs(in.jacobian[e]));
      }
    }
    return size;
  }
  bool is_local = false;

  TETWARP_HD LargestOf<2> operator()(std::int64_t c) const {
    LargestOf<2> largest;
    for (int a = 0; a < 3; ++a) {
      largest.value[0] = max_of(largest.value[0], size_of_row(3 * c + a, is_local));
    }
    if (in.gap.size > 0 && !is_local) {
      largest.value[1] =
          max_of(fabs(in.gap[3 * c]), fabs(mul_rn(in.time_step, in.given_velocity[3 * c])));
    }
    return largest;
  }
};

/// One index = one contact: 1 where its rows are zero or within rounding of zero, or where its
/// normal spring has another gap than dt w_n.
struct ContactCheckOp {
  ContactScalesOp scales;
  const LargestOf<2>* largest;

  TETWARP_HD BadCount operator()(std::int64_t c) const {
    const ContactInput& in = scales.in;
    const double share = scales.is_local ? delassus_rounding.resident : jacobian_rounding.resident;
    const double rounding = share * largest->value[0];
    double size[3];
    for (int a = 0; a < 3; ++a) size[a] = scales.size_of_row(3 * c + a, scales.is_local);
    const View<const double> tangential =
        in.tangential_stiffness.size > 0 ? in.tangential_stiffness : in.stiffness;
    const bool has_spring = in.has_adhesion && in.intensity[c] > 0;
    const bool resists =
        in.friction[c] > 0 || (has_spring && tangential.size > 0 && tangential[c] > 0);
    const double push = max_of(size[1], size[2]);
    bool is_bad =
        !(size[0] > rounding) || size[1] < 0 || size[2] < 0 || (resists && !(push > rounding));
    if (has_spring && in.gap.size > 0 && !scales.is_local && in.area.size > 0 &&
        in.stiffness.size > 0) {
      const double difference =
          add_rn(in.gap[3 * c], -mul_rn(in.time_step, in.given_velocity[3 * c]));
      is_bad = is_bad || fabs(difference) > spring_rounding.resident * largest->value[1];
    }
    return {{is_bad ? 1.0 : 0.0}};
  }
};

/// One index = one row of W: 1 where an entry is larger than a positive semidefinite matrix allows.
struct SemidefiniteCheckOp {
  ContactScalesOp scales;
  const LargestOf<2>* largest;

  TETWARP_HD BadCount operator()(std::int64_t row) const {
    const double own = sqrt(max_of(scales.size_of_row(row, true), 0.0));
    for (std::int64_t e = scales.rows.row_start[row]; e < scales.rows.row_start[row + 1]; ++e) {
      const double other = sqrt(max_of(scales.size_of_row(scales.rows.column[e], true), 0.0));
      const double bound = semidefinite_slack.resident * own * other +
                           semidefinite_rounding.resident * largest->value[0];
      if (!(fabs(scales.in.matrix[e]) <= bound)) return {{1}};
    }
    return {};
  }
};

/// One index = one block of A: 1 where it is not symmetric, not clearly positive definite, or of
/// more than largest_dense_block dofs.
struct BlockCheckOp {
  View<const std::int64_t> dof_start;
  View<const std::int64_t> diagonal_value;
  View<const double> system;

  TETWARP_HD BadCount operator()(std::int64_t b) const {
    constexpr int most = largest_dense_block;
    const std::int64_t first = diagonal_value[b];
    const std::int64_t dofs = dof_start[b + 1] - dof_start[b];
    if (dofs > most) return {{1}};
    double factor[most][most];
    for (int j = 0; j < dofs; ++j) {
      double pivot = system[first + j * dofs + j];
      const double diagonal = pivot;
      for (int k = 0; k < j; ++k) pivot -= factor[j][k] * factor[j][k];
      if (!(pivot > smallest_pivot.resident * diagonal && diagonal > 0)) return {{1}};
      factor[j][j] = sqrt(pivot);
      for (int i = j + 1; i < dofs; ++i) {
        double sum = system[first + i * dofs + j];
        const double mirrored = system[first + j * dofs + i];
        const double size = max_of(diagonal, system[first + i * dofs + i]);
        if (!(fabs(sum - mirrored) <= asymmetry.resident * size)) return {{1}};
        for (int k = 0; k < j; ++k) sum -= factor[i][k] * factor[j][k];
        factor[i][j] = sum / factor[j][j];
      }
    }
    return {};
  }
};

}  // namespace tetwarp
