/// @file exact_sign.hpp
/// Exact signs of determinants of points, for tests of what intersects.
///
/// A bound of the rounding error decides most cases; the others are computed exactly, as sums of
/// float64 numbers that do not overlap. Source: Shewchuk 1997, "Adaptive Precision Floating-Point
/// Arithmetic and Fast Robust Geometric Predicates"; none of its code.
#pragma once
#include <array>

namespace tetwarp::reference {

/// Sign of the determinant |a - d, b - d, c - d|: -1, 0 or 1. Positive where d lies on the side of
/// a, b, c from which these go round clockwise.
/// @pre all coordinates 0 or with absolute values between 1e-90 and 1e90
int orientation(const std::array<double, 3>& a,
                const std::array<double, 3>& b,
                const std::array<double, 3>& c,
                const std::array<double, 3>& d);

/// The same of |a - c, b - c| in a plane: positive where a, b, c go round counter-clockwise.
int orientation(const std::array<double, 2>& a,
                const std::array<double, 2>& b,
                const std::array<double, 2>& c);

}  // namespace tetwarp::reference
