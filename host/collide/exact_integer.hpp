/// @file exact_integer.hpp
/// Integers of any size, for signs that no rounding may change.
#pragma once
#include <cstdint>
#include <vector>

namespace tetwarp {

/// Sign and magnitude.
class ExactInteger {
 public:
  ExactInteger() = default;
  ExactInteger(std::int64_t value);
  /// value * 2^shift. @pre this is a whole number, value finite
  ExactInteger(double value, int shift);

  ExactInteger operator-() const;
  ExactInteger operator+(const ExactInteger& other) const;
  ExactInteger operator-(const ExactInteger& other) const { return *this + -other; }
  ExactInteger operator*(const ExactInteger& other) const;
  bool operator<(const ExactInteger& other) const { return (*this - other).sign() < 0; }

  int sign() const { return digits_.empty() ? 0 : negative_ ? -1 : 1; }

 private:
  using Digits = std::vector<std::uint32_t>;  ///< the lowest first; the last is not 0
  static bool is_less(const Digits& a, const Digits& b);
  static Digits sum(const Digits& a, const Digits& b);
  static Digits difference(const Digits& a, const Digits& b);  ///< @pre a >= b
  static void trim(Digits& digits);
  void set_shifted(std::uint64_t magnitude, int shift);

  Digits digits_;
  bool negative_ = false;
};

}  // namespace tetwarp
