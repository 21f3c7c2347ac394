/// @file check_limits.hpp
/// Limits of the numbers of a contact problem that its checks accept.
#pragma once

namespace tetwarp {

/// One limit in two places. check_problem() on the host compares with `host`. Arrays in memory of a
/// device are compared there with `resident`, which is stricter by more than what the two round
/// differently (they sum and factorize in other orders, and the device measures some sizes more
/// coarsely): so what the device accepts, the host would accept, and what the device does not
/// accept is copied and decided by the host.
struct CheckLimit {
  double host, resident;
};

/// Rows of J below this share of the largest entry are what rounding leaves of zero.
constexpr CheckLimit jacobian_rounding{1e-14, 1e-13};
/// The same of the diagonal of W, which is a square of rows over a mass; masses may differ by
/// twelve digits.
constexpr CheckLimit delassus_rounding{1e-30, 1e-29};
/// |W_ij| over the geometric mean of W_ii and W_jj, at most 1 in a positive semidefinite matrix.
/// Recorded matrices may be asymmetric by 10 %.
constexpr CheckLimit semidefinite_slack{1.1, 1.09};
/// The same bound is larger by this share of the largest W_ii.
constexpr CheckLimit semidefinite_rounding{1e-9, 0.99e-9};
/// The gap of a normal spring is dt w_n up to this share of the largest gap.
constexpr CheckLimit spring_rounding{1e-9, 0.99e-9};
/// Entries of A and their mirror images, relative. The host compares with the largest entry of
/// either row, the device with the diagonals.
constexpr CheckLimit asymmetry{1e-9, 0.5e-9};
/// Pivots of blocks of A relative to their diagonals: in a singular block, rounding leaves about
/// 1e-15.
constexpr CheckLimit smallest_pivot{1e-14, 1e-13};
/// Dofs of a block of A that is factorized as a dense matrix; larger ones are left to the host.
constexpr int largest_dense_block = 12;

}  // namespace tetwarp
