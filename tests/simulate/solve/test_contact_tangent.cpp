/// @file test_contact_tangent.cpp
/// The linear law of one contact, against the law itself.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "kernels/contact/contact_residual.hpp"
#include "kernels/contact/contact_tangent.hpp"

namespace tetwarp::test {
namespace {
using Eigen::Matrix3d;
using Eigen::Vector3d;
using RowMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

class ContactTangents : public ::testing::Test {
 protected:
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  double symmetric() { return 2 * unit() - 1; }

  ContactConstants<double> make_contact(double spring) {
    ContactConstants<double> c = {};
    for (int a = 0; a < 3; ++a) {
      for (int e = 0; e <= a; ++e) {
        c.block[3 * a + e] = c.block[3 * e + a] = a == e ? 1 + unit() : 0.3 * symmetric();
      }
    }
    c.tangent_metric = larger_eigenvalue(c.block[4], c.block[5], c.block[8]);
    c.normal_spring = spring;
    c.tangent_spring = spring * unit();
    for (double& offset : c.tangent_offset) offset = symmetric();
    c.kind = ContactKind::adhesive;
    return c;
  }

 private:
  std::mt19937 random_{5};
};

/// Newton's method with u = free + B r. @returns how far the result is off its law
double solve(const ContactConstants<double>& c, const Vector3d& free) {
  const Matrix3d block = Eigen::Map<const RowMatrix3d>(c.block);
  const Vector3d springs(c.normal_spring, c.tangent_spring, c.tangent_spring);
  Vector3d r = Vector3d::Zero(), u = free;
  double softness = 1e-2;
  for (int step = 0; step < 12; ++step, softness = std::max(softness / 5, 1e-8)) {
    const ContactTangent t = ContactTangentOp{softness}(c, normal_weight(c), r.data(), u.data());
    Matrix3d slope = springs.asDiagonal();
    slope(0, 0) += t.slope;
    const Vector3d offset(t.offset[0], t.offset[1], t.offset[2]);
    const Vector3d change = (Matrix3d::Identity() + block * slope).lu().solve(-block * offset);
    u += change;
    r -= offset + slope * change;
  }
  return std::sqrt(natural_square(c, {}, normal_weight(c), tangent_weight(c), r.data(), u.data()));
}

TEST_F(ContactTangents, NewtonsMethodFindsTheImpulseOfAContact) {
  for (const double spring : {0.0, 0.1, 10.0}) {
    for (int trial = 0; trial < 200; ++trial) {
      const ContactConstants<double> c = make_contact(spring);
      const Vector3d free(symmetric(), symmetric(), symmetric());
      ASSERT_LT(solve(c, free), 1e-9) << spring << " " << trial;
    }
  }
}

/// At an impulse and a velocity that obey the law, the linear law has the same impulse.
TEST_F(ContactTangents, ImpulsesThatObeyTheLawStay) {
  const ContactConstants<double> c = make_contact(0);
  const Vector3d states[][2] = {{{0, 0, 0}, {0.5, 0.2, 0.1}},  // open
                                {{1, 0, 0}, {0, 2, 0}}};       // slides along
  for (const auto& [impulse, velocity] : states) {
    const ContactTangent t =
        ContactTangentOp{1e-3}(c, normal_weight(c), impulse.data(), velocity.data());
    for (const double offset : t.offset) EXPECT_EQ(offset, 0);
  }
}

}  // namespace
}  // namespace tetwarp::test
