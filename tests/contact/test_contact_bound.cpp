/// @file test_contact_bound.cpp
/// Bounds of eta that hold for any block of the Delassus matrix above the one known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "kernels/contact/contact_bound.hpp"

namespace tetwarp::test {
namespace {
using Constants = ContactConstants<double>;

/// One contact that obeys its law, similar velocities, and its block, of which only a lower bound
/// is known.
struct BoundCase {
  explicit BoundCase(std::uint32_t seed) : random(seed) {
    known.friction = draw(0, 1);
    known.kind = ContactKind::adhesive;
    if (seed % 3 != 0) known.normal_spring = known.tangent_spring = std::pow(10, draw(-2, 2));
    known.tangent_offset[0] = seed % 3 != 0 ? draw(-1, 1) : 0;
    known.block[0] = draw(0.5, 2);
    known.tangent_metric = draw(0.5, 2);
    exact = known;
    exact.block[0] *= std::pow(10, draw(0, 3));
    exact.tangent_metric *= std::pow(10, draw(0, 3));
    const bool is_open = seed % 4 == 0, slides = seed % 4 == 1;
    consistent[0] = is_open ? draw(0, 1) : 0;
    const double push = is_open ? 0 : draw(0, 2), angle = draw(0, 6);
    const double slip = is_open || slides ? draw(0, 1) : 0;
    const double pull = known.friction * push * (slides ? 1 : draw(0, 1));
    const double along[2] = {std::cos(angle), std::sin(angle)};
    impulse[0] = push - known.normal_spring * consistent[0];
    for (int a = 0; a < 2; ++a) {
      consistent[1 + a] = slip * along[a];
      impulse[1 + a] =
          -pull * along[a] - known.tangent_spring * (consistent[1 + a] + known.tangent_offset[a]);
    }
    const double distance = std::pow(10, draw(-3, 0));
    for (int a = 0; a < 3; ++a) velocity[a] = consistent[a] + distance * draw(-1, 1);
  }

  double draw(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }
  ContactResidualOp<double> natural(const double* r, const double* u) const {
    return {{&known, 1}, {}, {r, 3}, {u, 3}, {zero, 3}};
  }

  std::mt19937 random;
  Constants known = {}, exact = {};
  double impulse[3], consistent[3], velocity[3];
  static constexpr double zero[3] = {0, 0, 0};
};

TEST(ContactBound, EtaIsAtMostTheBound) {
  double closest = 0;
  for (std::uint32_t seed = 0; seed < 2000; ++seed) {
    const BoundCase c(seed);
    ASSERT_LE(eta_square(c.exact, {}, c.impulse, c.consistent), 1e-24) << seed;

    const double bound =
        ResidualBoundOp{c.natural(c.impulse, c.velocity), {c.consistent, 3}}(0).eta;

    const double eta = eta_square(c.exact, {}, c.impulse, c.velocity);
    EXPECT_LE(eta, (1 + 1e-9) * bound + 1e-24) << seed;
    closest = std::max(closest, eta / bound);
  }
  EXPECT_GT(closest, 0.9);
}

TEST(ContactBound, TheEtaOfNoImpulsesIsAtLeastTheBound) {
  double closest = 0;
  for (std::uint32_t seed = 0; seed < 2000; ++seed) {
    const BoundCase c(seed);

    const double bound = FreeResidualBoundOp{c.natural(BoundCase::zero, c.velocity)}(0).eta;

    const double eta = eta_square(c.exact, {}, BoundCase::zero, c.velocity);
    EXPECT_GE(eta, bound) << seed;
    if (eta > 0) closest = std::max(closest, bound / eta);
  }
  EXPECT_GT(closest, 0.8);  // 0.8 / 0.978 where it is tightest
}
}  // namespace
}  // namespace tetwarp::test
