/// @file test_contact_law.cpp
/// The solution of one contact, against constructed solutions and against each condition of the
/// laws.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "kernels/contact/contact_law.hpp"

namespace tetwarp::test {
namespace {
using Wide = long double;
using Vector = std::array<Wide, 3>;

constexpr ContactSwitches variants[] = {{false, false}, {false, true}, {true, false}, {true, true}};

Wide length(Wide x, Wide y) {
  return std::sqrt(x * x + y * y);
}

template <class T>
class ContactLaw : public ::testing::Test {
 protected:
  static constexpr Wide rounding = std::numeric_limits<T>::epsilon();

  Wide unit() { return std::uniform_real_distribution<double>(0, 1)(random); }
  Wide symmetric() { return 2 * unit() - 1; }
  Wide power(Wide low, Wide high) { return std::pow(Wide(10), low + (high - low) * unit()); }

  /// Entries of a positive definite block of about `size`, coupled by up to `coupling`.
  void set_block(ContactConstants<T>& c, Wide size, Wide coupling, bool is_isotropic) {
    const Wide normal = size * (1 + unit()), first = size * (1 + unit());
    const Wide second = is_isotropic ? first : size * (1 + unit());
    const Wide own[3] = {normal, first, second};
    for (int a = 0; a < 3; ++a) {
      for (int e = 0; e <= a; ++e) {
        const Wide value = a == e ? own[a] : coupling * size * symmetric();
        c.block[3 * a + e] = c.block[3 * e + a] = static_cast<T>(value);
      }
    }
    c.tangent_metric = larger_eigenvalue(c.block[4], c.block[5], c.block[8]);
  }
  ContactConstants<T> make_contact(Wide block, Wide coupling, bool is_isotropic) {
    ContactConstants<T> c = {};
    set_block(c, block, coupling, is_isotropic);
    c.kind = ContactKind::adhesive;
    return c;
  }
  /// Repeats the update of the contact until its impulse does not change.
  std::array<T, 3> solve(const ContactConstants<T>& c,
                         ContactSwitches switches,
                         const Vector& free,
                         int visits) {
    std::array<T, 3> impulse = {};
    for (int visit = 0; visit < visits; ++visit) {
      T velocity[3];
      for (std::size_t a = 0; a < 3; ++a) {
        Wide sum = free[a];
        for (std::size_t e = 0; e < 3; ++e) sum += Wide(c.block[3 * a + e]) * impulse[e];
        velocity[a] = static_cast<T>(sum);
      }
      solve_contact(c, switches, velocity, impulse.data());
    }
    return impulse;
  }

  std::mt19937 random{41};
};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(ContactLaw, Scalars);

/// Impulse of contact and friction that obeys the law at velocity `u`; `trial` selects open,
/// sticking or sliding (pyramid: per axis).
template <class T>
Vector lawful_force(
    const ContactConstants<T>& c, ContactSwitches switches, int trial, Wide size, Vector& u) {
  const Wide kappa = c.tangent_spring, o[2] = {c.tangent_offset[0], c.tangent_offset[1]};
  const auto left = [&](Wide stretch) {
    return std::max(c.friction * size - (switches.restrictive ? kappa * stretch : 0), Wide(0));
  };
  if (trial % 3 == 0) return {0, 0, 0};
  u[0] = 0;
  if (trial % 3 == 1) u[1] = u[2] = 0;
  Vector nu = {size, 0, 0};
  if (!switches.pyramid) {
    const Wide speed = length(u[1], u[2]), bound = left(length(u[1] + o[0], u[2] + o[1]));
    nu[1] = speed > 0 ? -bound * u[1] / speed : 0.6L * bound;
    nu[2] = speed > 0 ? -bound * u[2] / speed : -0.7L * bound;
    return nu;
  }
  if (trial % 2 == 0) u[2] = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    const Wide bound = left(std::abs(u[a] + o[a - 1]));
    nu[a] = u[a] > 0 ? -bound : u[a] < 0 ? bound : 0.8L * bound;
  }
  return nu;
}

/// A contact with an isotropic tangential block is solved by one visit, for springs of 1e-12 to
/// 1e12 times its mass and friction from 0 to 1000.
TYPED_TEST(ContactLaw, OneVisitFindsTheImpulseOfAnIsotropicContact) {
  using T = TypeParam;
  for (const ContactSwitches switches : variants) {
    for (int trial = 0; trial < 600; ++trial) {
      const Wide mass = this->power(-4, 4);
      ContactConstants<T> c = this->make_contact(1 / mass, 0, true);
      c.friction = static_cast<T>(trial % 5 == 0 ? 0 : this->power(-3, 3));
      if (trial % 7 != 0) {
        c.normal_spring = static_cast<T>(mass * this->power(-12, 12));
        c.tangent_spring = static_cast<T>(mass * this->power(-12, 12));
      } else {
        c.kind = ContactKind::coulomb;
      }
      for (T& offset : c.tangent_offset) offset = static_cast<T>(this->symmetric());
      Vector u = {this->unit(), this->symmetric(), this->symmetric()};
      const Vector nu = lawful_force(c, switches, trial, mass * this->unit(), u);
      const Wide kappa[3] = {c.normal_spring, c.tangent_spring, c.tangent_spring};
      const Wide stretch[3] = {u[0], u[1] + c.tangent_offset[0], u[2] + c.tangent_offset[1]};
      Vector r, free;
      Wide speed = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        r[a] = nu[a] - kappa[a] * stretch[a];
        free[a] = u[a] - c.block[4 * a] * r[a];
        speed = std::max({speed, std::abs(free[a]), std::abs(stretch[a]), std::abs(u[a])});
      }

      const std::array<T, 3> found = this->solve(c, switches, free, 1);

      // Rounding of free velocities, as impulses.
      const Wide bound = 64 * this->rounding * (1 + Wide(c.friction)) * speed / c.block[0];
      for (std::size_t a = 0; a < 3; ++a) {
        ASSERT_LE(std::abs(found[a] - r[a]), bound)
            << "row " << a << ", trial " << trial << ", pyramid " << switches.pyramid
            << ", restrictive " << switches.restrictive << ", found " << found[a] << " for "
            << r[a];
      }
    }
  }
}

/// Repeated visits converge to the laws for any coupled block: normal complementarity, friction
/// within its disc (box), and maximal dissipation.
TYPED_TEST(ContactLaw, VisitsEndWhereEveryLawHolds) {
  using T = TypeParam;
  int open = 0, sticking = 0, sliding = 0;
  for (const ContactSwitches switches : variants) {
    for (int trial = 0; trial < 200; ++trial) {
      ContactConstants<T> c = this->make_contact(1, 0.4L, false);
      c.friction = static_cast<T>(trial % 5 == 0 ? 0 : this->power(-1.5L, 0.2L));
      if (trial % 7 != 0) {
        c.normal_spring = static_cast<T>(this->power(-3, 2));
        c.tangent_spring = static_cast<T>(this->power(-3, 2));
      } else {
        c.kind = ContactKind::coulomb;
      }
      for (T& offset : c.tangent_offset) offset = static_cast<T>(0.1L * this->symmetric());
      const Wide slow = trial % 3 == 0 ? 0.1L : 1;
      const Vector free = {this->symmetric(), slow * this->symmetric(), slow * this->symmetric()};

      const std::array<T, 3> r = this->solve(c, switches, free, 400);

      Vector u = free, nu;
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t e = 0; e < 3; ++e) u[a] += Wide(c.block[3 * a + e]) * r[e];
      }
      const Wide pull[2] = {c.tangent_spring * (u[1] + c.tangent_offset[0]),
                            c.tangent_spring * (u[2] + c.tangent_offset[1])};
      nu = {r[0] + c.normal_spring * u[0], r[1] + pull[0], r[2] + pull[1]};
      const Wide bound = 200 * this->rounding * (1 + Wide(c.normal_spring) + c.tangent_spring);
      ASSERT_GE(nu[0], -bound);
      ASSERT_GE(u[0], -bound);
      ASSERT_LE(std::abs(nu[0] * u[0]), bound);
      const auto limit = [&](Wide spring) {
        const Wide chi = switches.restrictive ? 1 : 0;
        return std::max(c.friction * std::max(nu[0], Wide(0)) - chi * spring, Wide(0));
      };
      const Wide radius[2] = {
          limit(switches.pyramid ? std::abs(pull[0]) : length(pull[0], pull[1])),
          limit(switches.pyramid ? std::abs(pull[1]) : length(pull[0], pull[1]))};
      if (switches.pyramid) {
        ASSERT_LE(std::abs(nu[1]) - radius[0], bound);
        ASSERT_LE(std::abs(nu[2]) - radius[1], bound);
      } else {
        ASSERT_LE(length(nu[1], nu[2]) - radius[0], bound);
      }
      const Wide power = nu[1] * u[1] + nu[2] * u[2];
      for (int k = 0; k < 64; ++k) {
        const Wide angle = k * std::numbers::pi_v<Wide> / 32;
        Wide x = std::cos(angle), y = std::sin(angle);
        if (switches.pyramid) {
          x = x < 0 ? -1 : 1;
          y = y < 0 ? -1 : 1;
        }
        ASSERT_GE(radius[0] * x * u[1] + radius[1] * y * u[2], power - bound)
            << "trial " << trial << ", pyramid " << switches.pyramid << ", restrictive "
            << switches.restrictive;
      }
      open += u[0] > bound;
      sticking += nu[0] > bound && length(u[1], u[2]) <= bound;
      sliding += nu[0] > bound && length(u[1], u[2]) > bound && radius[0] > bound;
    }
  }
  EXPECT_GT(open, 100);
  EXPECT_GT(sticking, 30);
  EXPECT_GT(sliding, 100);
}

TYPED_TEST(ContactLaw, WithoutFrictionAndSpringsTangentsCarryNothing) {
  using T = TypeParam;
  for (const ContactKind kind : {ContactKind::frictionless, ContactKind::coulomb}) {
    ContactConstants<T> c = this->make_contact(1, 0.3L, false);
    c.kind = kind;
    for (const Wide normal : {-1.0L, 1.0L}) {
      const std::array<T, 3> r = this->solve(c, {}, {normal, 2, -3}, 1);

      EXPECT_EQ(r[0], normal < 0 ? T(1) / c.block[0] : T(0));
      EXPECT_EQ(r[1], T(0));
      EXPECT_EQ(r[2], T(0));
    }
  }
}

/// Without friction both laws and both rules are equal.
TYPED_TEST(ContactLaw, WithoutFrictionTheSpringsAloneAct) {
  using T = TypeParam;
  ContactConstants<T> c = {};
  c.block[0] = c.block[4] = c.block[8] = c.tangent_metric = 2;
  c.normal_spring = T(0.5);
  c.tangent_spring = T(1.5);
  c.tangent_offset[0] = 1;
  c.kind = ContactKind::adhesive;
  for (const ContactSwitches switches : variants) {
    const std::array<T, 3> r = this->solve(c, switches, {4, 3, -4}, 1);

    EXPECT_FLOAT_EQ(static_cast<float>(r[0]), -1);    // -0.5 * 4 / (1 + 0.5 * 2)
    EXPECT_FLOAT_EQ(static_cast<float>(r[1]), -1.5);  // -1.5 (3 + 1) / (1 + 1.5 * 2)
    EXPECT_FLOAT_EQ(static_cast<float>(r[2]), 1.5);
  }
}

/// A square of friction resists a diagonal slide sqrt(2) times as much as a disc.
TYPED_TEST(ContactLaw, TheDiscIsRoundAndTheBoxIsNot) {
  using T = TypeParam;
  ContactConstants<T> c = {};
  c.block[0] = c.block[4] = c.block[8] = c.tangent_metric = 1;
  c.friction = T(0.5);
  c.kind = ContactKind::coulomb;

  const std::array<T, 3> disc = this->solve(c, {}, {-1, 3, 4}, 1);
  const std::array<T, 3> box = this->solve(c, {.pyramid = true}, {-1, 3, 4}, 1);

  EXPECT_FLOAT_EQ(static_cast<float>(disc[1]), -0.3F);
  EXPECT_FLOAT_EQ(static_cast<float>(disc[2]), -0.4F);
  EXPECT_EQ(box[1], T(-0.5));
  EXPECT_EQ(box[2], T(-0.5));
}
}  // namespace
}  // namespace tetwarp::test
