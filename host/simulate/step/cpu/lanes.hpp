/// @file lanes.hpp
/// Vectors of numbers for the stages of a step, in the vector extension of GCC and Clang. Every
/// lane gets the bits that a single number would: no contraction, no reordering.
///
/// Included only by files compiled for one instruction set; see vector_stages.hpp.
#pragma once
#include <cmath>

#include "kernels/base/hd.hpp"

namespace tetwarp {

template <int width>
struct LaneVector;
template <>
struct LaneVector<2> {
  typedef double Numbers __attribute__((vector_size(16)));
  typedef long long Masks __attribute__((vector_size(16)));
};
template <>
struct LaneVector<4> {
  typedef double Numbers __attribute__((vector_size(32)));
  typedef long long Masks __attribute__((vector_size(32)));
};
template <>
struct LaneVector<8> {
  typedef double Numbers __attribute__((vector_size(64)));
  typedef long long Masks __attribute__((vector_size(64)));
};

/// Which lanes a condition holds in.
template <int width>
struct LaneMask {
  typename LaneVector<width>::Masks m;

  TETWARP_HD friend LaneMask operator&&(LaneMask a, LaneMask b) { return {a.m & b.m}; }
  TETWARP_HD friend LaneMask operator||(LaneMask a, LaneMask b) { return {a.m | b.m}; }
  TETWARP_HD bool operator[](int lane) const { return m[lane] != 0; }
};

template <int width>
struct Lanes {
  typename LaneVector<width>::Numbers v;

  Lanes() = default;
  TETWARP_HD explicit Lanes(double all) : v(typename LaneVector<width>::Numbers{} + all) {}
  TETWARP_HD explicit Lanes(typename LaneVector<width>::Numbers lanes) : v(lanes) {}

  TETWARP_HD friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v + b.v); }
  TETWARP_HD friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v - b.v); }
  TETWARP_HD friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v * b.v); }
  TETWARP_HD friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v / b.v); }
  TETWARP_HD friend Lanes operator-(Lanes a) { return Lanes(-a.v); }
  TETWARP_HD friend LaneMask<width> operator<(Lanes a, Lanes b) { return {a.v < b.v}; }
  TETWARP_HD friend LaneMask<width> operator>(Lanes a, Lanes b) { return {a.v > b.v}; }
  TETWARP_HD friend LaneMask<width> operator<=(Lanes a, Lanes b) { return {a.v <= b.v}; }
};

template <int width>
TETWARP_HD Lanes<width> select(LaneMask<width> condition, Lanes<width> yes, Lanes<width> no) {
  return Lanes<width>(condition.m ? yes.v : no.v);
}
template <int width>
TETWARP_HD Lanes<width> root_of(Lanes<width> x) {
  Lanes<width> root;
  for (int k = 0; k < width; ++k) root.v[k] = __builtin_sqrt(x.v[k]);
  return root;
}
template <int width>
TETWARP_HD bool any_of(LaneMask<width> condition) {
  long long any = 0;
  for (int k = 0; k < width; ++k) any |= condition.m[k];
  return any != 0;
}

/// Three numbers of a block's column in one vector of four, the last of them not used.
struct LaneColumn {
  typedef double Four __attribute__((vector_size(32)));
  Four v = {};

  /// Reads one number beyond the three.
  TETWARP_HD static LaneColumn loaded(const double* from) {
    LaneColumn column;
    __builtin_memcpy(&column.v, from, sizeof(Four));
    return column;
  }
  TETWARP_HD void store(double* to) const {
    for (int i = 0; i < 3; ++i) to[i] = v[i];
  }
  TETWARP_HD void add(const LaneColumn& a, double x, const LaneColumn& b, double y) {
    v += a.v * x + b.v * y;
  }
};

}  // namespace tetwarp
