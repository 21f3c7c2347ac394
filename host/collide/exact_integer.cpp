#include "host/collide/exact_integer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tetwarp {

ExactInteger::ExactInteger(std::int64_t value) : negative_(value < 0) {
  const auto bits = static_cast<std::uint64_t>(value);
  set_shifted(negative_ ? 0 - bits : bits, 0);
}

ExactInteger::ExactInteger(double value, int shift) : negative_(value < 0) {
  constexpr int mantissa_bits = std::numeric_limits<double>::digits;
  int exponent = 0;
  const double fraction = std::frexp(std::abs(value), &exponent);
  const auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, mantissa_bits));
  set_shifted(mantissa, exponent - mantissa_bits + shift);
}

/// magnitude * 2^shift; of a negative shift the bits that are dropped are 0.
void ExactInteger::set_shifted(std::uint64_t magnitude, int shift) {
  if (shift < 0) {
    magnitude = shift > -64 ? magnitude >> -shift : 0;
    shift = 0;
  }
  digits_.assign(static_cast<std::size_t>(shift / 32), 0);
  const int within = shift % 32;
  digits_.push_back(static_cast<std::uint32_t>(magnitude << within));
  digits_.push_back(static_cast<std::uint32_t>(magnitude >> (32 - within)));
  digits_.push_back(within == 0 ? 0 : static_cast<std::uint32_t>(magnitude >> 32 >> (32 - within)));
  trim(digits_);
}

void ExactInteger::trim(Digits& digits) {
  while (!digits.empty() && digits.back() == 0) digits.pop_back();
}

bool ExactInteger::is_less(const Digits& a, const Digits& b) {
  if (a.size() != b.size()) return a.size() < b.size();
  return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
}

ExactInteger::Digits ExactInteger::sum(const Digits& a, const Digits& b) {
  Digits result(std::max(a.size(), b.size()) + 1);
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    carry += (i < a.size() ? a[i] : 0);
    carry += (i < b.size() ? b[i] : 0);
    result[i] = static_cast<std::uint32_t>(carry);
    carry >>= 32;
  }
  trim(result);
  return result;
}

ExactInteger::Digits ExactInteger::difference(const Digits& a, const Digits& b) {
  Digits result(a.size());
  std::int64_t borrow = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::int64_t digit = std::int64_t{a[i]} - borrow - (i < b.size() ? b[i] : 0);
    borrow = digit < 0 ? 1 : 0;
    digit += borrow << 32;
    result[i] = static_cast<std::uint32_t>(digit);
  }
  trim(result);
  return result;
}

ExactInteger ExactInteger::operator-() const {
  ExactInteger result = *this;
  result.negative_ = !negative_;
  return result;
}

ExactInteger ExactInteger::operator+(const ExactInteger& other) const {
  ExactInteger result;
  if (negative_ == other.negative_) {
    result.digits_ = sum(digits_, other.digits_);
    result.negative_ = negative_;
    return result;
  }
  const bool other_is_larger = is_less(digits_, other.digits_);
  result.digits_ =
      other_is_larger ? difference(other.digits_, digits_) : difference(digits_, other.digits_);
  result.negative_ = other_is_larger ? other.negative_ : negative_;
  return result;
}

ExactInteger ExactInteger::operator*(const ExactInteger& other) const {
  ExactInteger result;
  result.negative_ = negative_ != other.negative_;
  result.digits_.assign(digits_.size() + other.digits_.size(), 0);
  for (std::size_t i = 0; i < digits_.size(); ++i) {
    std::uint64_t carry = 0;
    for (std::size_t k = 0; k < other.digits_.size(); ++k) {
      carry += result.digits_[i + k] + std::uint64_t{digits_[i]} * other.digits_[k];
      result.digits_[i + k] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    result.digits_[i + other.digits_.size()] = static_cast<std::uint32_t>(carry);
  }
  trim(result.digits_);
  return result;
}

}  // namespace tetwarp
