#include "tests/oracles/exact_sign.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace tetwarp::reference {
namespace {

/// A number as the exact sum of parts that do not overlap, the smallest first; no part is 0.
class ExactNumber {
 public:
  /// a - b.
  static ExactNumber difference(double a, double b) {
    ExactNumber result;
    result.add(a);
    result.add(-b);
    return result;
  }

  ExactNumber operator+(const ExactNumber& other) const {
    ExactNumber result = *this;
    for (const double part : other.parts_) result.add(part);
    return result;
  }
  ExactNumber operator-(const ExactNumber& other) const {
    ExactNumber result = *this;
    for (const double part : other.parts_) result.add(-part);
    return result;
  }
  ExactNumber operator*(const ExactNumber& other) const {
    ExactNumber result;
    for (const double a : parts_) {
      for (const double b : other.parts_) {
        const double product = a * b;
        result.add(std::fma(a, b, -product));
        result.add(product);
      }
    }
    return result;
  }

  int sign() const {
    if (parts_.empty()) return 0;
    return parts_.back() > 0 ? 1 : -1;
  }

 private:
  void add(double x) {
    std::size_t kept = 0;
    for (const double part : parts_) {
      const double sum = x + part, other = sum - x;
      const double error = (x - (sum - other)) + (part - other);
      if (error != 0) parts_[kept++] = error;
      x = sum;
    }
    parts_.resize(kept);
    if (x != 0) parts_.push_back(x);
  }

  std::vector<double> parts_;
};

constexpr double rounding = std::numeric_limits<double>::epsilon() / 2;

}  // namespace

int orientation(const std::array<double, 3>& a,
                const std::array<double, 3>& b,
                const std::array<double, 3>& c,
                const std::array<double, 3>& d) {
  const std::array<double, 3>* const corner[3] = {&a, &b, &c};
  double m[3][3];
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t i = 0; i < 3; ++i) m[row][i] = (*corner[row])[i] - d[i];
  }
  double value = 0, size = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double first = m[1][j] * m[2][k], second = m[1][k] * m[2][j];
    value += m[0][i] * (first - second);
    size += std::abs(m[0][i]) * (std::abs(first) + std::abs(second));
  }
  // Each term passes through three differences, two products and four sums at most.
  if (std::abs(value) > 16 * rounding * size) return value > 0 ? 1 : -1;
  ExactNumber exact[3][3], sum;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t i = 0; i < 3; ++i) {
      exact[row][i] = ExactNumber::difference((*corner[row])[i], d[i]);
    }
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum = sum + exact[0][i] * (exact[1][j] * exact[2][k] - exact[1][k] * exact[2][j]);
  }
  return sum.sign();
}

int orientation(const std::array<double, 2>& a,
                const std::array<double, 2>& b,
                const std::array<double, 2>& c) {
  const double first = (a[0] - c[0]) * (b[1] - c[1]), second = (a[1] - c[1]) * (b[0] - c[0]);
  const double value = first - second;
  if (std::abs(value) > 8 * rounding * (std::abs(first) + std::abs(second))) {
    return value > 0 ? 1 : -1;
  }
  const ExactNumber exact =
      ExactNumber::difference(a[0], c[0]) * ExactNumber::difference(b[1], c[1]) -
      ExactNumber::difference(a[1], c[1]) * ExactNumber::difference(b[0], c[0]);
  return exact.sign();
}

}  // namespace tetwarp::reference
