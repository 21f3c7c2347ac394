/// @file vector_bodies.hpp
/// Stage bodies for entries of vectors.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"
#include "kernels/contact/contact_law.hpp"

namespace tetwarp {

/// One index = one entry: out = value.
template <class T>
struct FillOp {
  T value;
  View<T> out;

  TETWARP_HD void operator()(std::int64_t i) const { out[i] = value; }
};

/// One index = one entry, converted to another precision.
template <class To, class From>
struct ConvertOp {
  View<const From> in;
  View<To> out;

  TETWARP_HD void operator()(std::int64_t i) const { out[i] = static_cast<To>(in[i]); }
};

/// One index = one entry: its square.
template <class T>
struct SquareOp {
  View<const T> in;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const { return {{square_of(double{in[i]})}}; }
};

/// One index = one entry: its term of d . (to - from).
struct MoveSquareOp {
  View<const double> d, from, to;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const { return {{d[i] * (to[i] - from[i])}}; }
};

/// One index = one entry: 1 if it is not zero.
template <class T>
struct NonzeroOp {
  View<const T> in;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const { return {{in[i] != 0 ? 1.0 : 0.0}}; }
};

template <class Exec, class T>
void fill(Exec& exec, View<T> out, T value) {
  exec.for_each("contact/mix", out.size, FillOp<T>{value, out});
}

template <class Exec, class To, class From>
void convert(Exec& exec, View<const From> in, View<To> out) {
  exec.for_each("contact/mix", in.size, ConvertOp<To, From>{in, out});
}

/// View of the entries [first, last).
template <class T>
View<T> part_of(View<T> values, std::int64_t first, std::int64_t last) {
  return {values.data + first, last - first};
}

}  // namespace tetwarp
