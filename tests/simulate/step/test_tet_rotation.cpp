#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "kernels/body/tet_rotation.hpp"

namespace tetwarp::test {
namespace {
using Matrix = Eigen::Matrix3d;

constexpr int matrix_count = 20000;

/// Random matrices, one family per name.
class Families {
 public:
  struct Family {
    std::string name;
    std::function<Matrix()> make;
    double p99, p99_float;  ///< bounds on the angle [rad]
  };

  std::vector<Family> all() {
    return {
        {"mild", [this] { return Matrix(turn() * (Matrix::Identity() + 0.1 * gaussian())); }, 1e-13,
         2e-6},
        {"large", [this] { return with(power(-1, 1), power(-1, 1), power(-1, 1)); }, 1e-13, 5e-6},
        {"flat", [this] { return with(0.5 + unit(), 0.5 + unit(), power(-12, -2)); }, 1e-13, 2e-6},
        {"inverted",
         [this] {
           const double a = 0.5 + unit(), b = 0.5 + unit();
           return with(a, b, -0.8 * std::min(a, b) * unit());
         },
         1e-13, 5e-6},
        {"tie",
         [this] {
           const double b = 0.5 + unit();
           return with(b + unit(), b, -b * (1 - power(-8, -2)));
         },
         1e-6, 1e-5},
        {"needle",
         [this] {
           const double s = power(-8, -3);
           return with(1, s, s * unit());
         },
         1e-7, 1e-5},
        {"gaussian", [this] { return gaussian(); }, 1e-13, 5e-6}};
  }

 private:
  double unit() { return unit_(random_); }
  double power(double low, double high) { return std::pow(10, low + (high - low) * unit()); }
  Matrix gaussian() {
    Matrix a;
    for (int k = 0; k < 9; ++k) a(k / 3, k % 3) = normal_(random_);
    return a;
  }
  Matrix turn() {
    return Eigen::Quaterniond(normal_(random_), normal_(random_), normal_(random_),
                              normal_(random_))
        .normalized()
        .toRotationMatrix();
  }
  Matrix with(double s1, double s2, double s3) {
    return turn() * Eigen::Vector3d(s1, s2, s3).asDiagonal() * turn().transpose();
  }

  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> unit_;
};

/// The proper rotation nearest to F.
Matrix nearest_rotation(const Matrix& f) {
  const Eigen::JacobiSVD<Matrix> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

template <class T>
Matrix rotation_of(const Matrix& f) {
  T in[9], out[9];
  for (int k = 0; k < 9; ++k) in[k] = static_cast<T>(f(k / 3, k % 3));
  tet_rotation(in, out);
  Matrix r;
  for (int k = 0; k < 9; ++k) r(k / 3, k % 3) = static_cast<double>(out[k]);
  return r;
}

double angle_between(const Matrix& a, const Matrix& b) {
  return 2 * std::asin(std::min(1.0, (a - b).norm() / std::sqrt(8.0)));
}

double p99(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() * 99 / 100];
}

/// Tolerances follow from the condition of the rotation, eps / (s2 + s3), where it is bad.
TEST(TetRotation, IsTheNearestProperRotation) {
  Families families;
  for (const auto& family : families.all()) {
    std::vector<double> angles;
    for (int i = 0; i < matrix_count; ++i) {
      const Matrix f = family.make();
      angles.push_back(angle_between(rotation_of<double>(f), nearest_rotation(f)));
    }

    EXPECT_LT(p99(angles), family.p99) << family.name;
  }
}

TEST(TetRotation, InFloat32IsAccurateToItsRounding) {
  Families families;
  for (const auto& family : families.all()) {
    std::vector<double> angles;
    for (int i = 0; i < matrix_count; ++i) {
      const Matrix f = family.make().cast<float>().cast<double>();
      angles.push_back(angle_between(rotation_of<float>(f), nearest_rotation(f)));
    }

    EXPECT_LT(p99(angles), family.p99_float) << family.name;
  }
}

/// Near ties many rotations are almost as good: the trace is what must be reached.
TEST(TetRotation, ReachesTheLargestTrace) {
  Families families;
  for (const auto& family : families.all()) {
    double defect = 0;
    for (int i = 0; i < 2000; ++i) {
      const Matrix f = family.make();
      const double best = (nearest_rotation(f).transpose() * f).trace();
      const double found = (rotation_of<double>(f).transpose() * f).trace();
      defect = std::max(defect, (best - found) / f.norm());
    }

    EXPECT_LT(defect, 1e-14) << family.name;
  }
}

TEST(TetRotation, IsARotationForAnyMatrix) {
  const auto diagonal = [](double a, double b, double c) {
    return Matrix(Eigen::Vector3d(a, b, c).asDiagonal());
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Matrix matrices[] = {Matrix::Zero(),
                             -Matrix::Identity(),
                             1e-200 * Matrix::Identity(),
                             1e-310 * Matrix::Identity(),
                             1e150 * Matrix::Identity(),
                             Matrix::Constant(1),
                             diagonal(1, 0, 0),
                             diagonal(1, 1, 0),
                             diagonal(1e-30, 1, 1),
                             diagonal(1, 1, -1),
                             diagonal(nan, 1, 1),
                             1e308 * Matrix::Constant(1),
                             diagonal(std::numeric_limits<double>::infinity(), 1, 1)};
  for (const Matrix& f : matrices) {
    const Matrix r = rotation_of<double>(f);

    EXPECT_LT((r.transpose() * r - Matrix::Identity()).norm(), 1e-15) << f;
    EXPECT_NEAR(r.determinant(), 1, 1e-15) << f;
  }
}

}  // namespace
}  // namespace tetwarp::test
