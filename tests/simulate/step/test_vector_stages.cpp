#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "tests/simulate/usable_stages.hpp"

namespace tetwarp::test {
namespace {
template <class T>
View<T> view(std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}
template <class T>
View<const T> const_view(const std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}

/// Random, inverted, flat and needle-shaped tetrahedra, some of them at rest.
class TetScene {
 public:
  explicit TetScene(int count) : corner_(4 * static_cast<std::size_t>(count)) {
    const auto tets = static_cast<std::size_t>(count);
    for (std::size_t n = 0; n < 4 * tets; ++n) {
      for (int i = 0; i < 3; ++i) position_.push_back(normal_(random_));
      moved_.push_back(n / 4 % 5 != 3);
    }
    for (std::size_t t = 0; t < tets; ++t) {
      for (std::size_t a = 0; a < 4; ++a) {
        corner_[a * tets + t] = static_cast<std::int32_t>(4 * t + a);
        node_.push_back(static_cast<std::int32_t>(4 * t + a));
      }
      double* const x = position_.data() + 12 * t;
      for (int k = 0; k < 12; ++k) {
        if (t % 7 == 1) x[k] = k % 3 == 2 ? 0 : x[k];            // flat
        if (t % 7 == 2) x[k] = k % 3 == 0 ? x[k] : 1e-7 * x[k];  // needle
        if (t % 7 == 3) x[k] = 1;                                // a point
      }
    }
    for (std::size_t k = 0; k < 9 * tets; ++k) gradient_.push_back(normal_(random_));
    for (std::size_t t = 0; t < tets; ++t) {
      lambda_.push_back(1 + std::abs(normal_(random_)));
      mu_.push_back(1 + std::abs(normal_(random_)));
    }
  }

  struct Result {
    std::vector<TetTurned> turned;
    std::vector<TetForce> force;
    std::vector<std::uint8_t> has_turned, is_skipped;
    bool operator==(const Result& other) const {
      const auto same = [](const auto& a, const auto& b) {
        return a.size() == b.size() &&
               (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
      };
      return same(turned, other.turned) && same(force, other.force) &&
             has_turned == other.has_turned && is_skipped == other.is_skipped;
    }
  };

  template <class Run>
  Result result_of(const Run& run) {
    const std::size_t tets = lambda_.size();
    Result result{std::vector<TetTurned>(tets), std::vector<TetForce>(tets),
                  std::vector<std::uint8_t>(tets), std::vector<std::uint8_t>(tets)};
    const TetConstants constants{const_view(corner_), const_view(gradient_),
                                 const_view(lambda_), const_view(mu_),
                                 const_view(mu_),     static_cast<std::int64_t>(tets)};
    const TetForceOp body{constants,
                          const_view(position_),
                          const_view(moved_),
                          true,
                          view(result.turned),
                          view(result.force),
                          view(result.has_turned),
                          view(result.is_skipped)};
    run(body);
    return result;
  }

  TetShapes shapes() const {
    return {const_view(node_),   const_view(gradient_), const_view(mu_),
            const_view(lambda_), const_view(mu_),       const_view(position_)};
  }

 private:
  std::mt19937 random_{5};
  std::normal_distribution<double> normal_;
  std::vector<std::int32_t> corner_, node_;
  std::vector<double> position_, gradient_, lambda_, mu_;
  std::vector<std::uint8_t> moved_;
};

TEST(VectorStages, ForcesHaveTheBitsOfSingleTetrahedra) {
  for (const int count : {0, 1, 3, 8, 31, 1025}) {
    TetScene scene(count);
    const auto single = scene.result_of([&](const TetForceOp& body) {
      for (std::int64_t t = 0; t < count; ++t) body(t);
    });
    for (const VectorStages* stages : usable_stages()) {
      const auto vectors =
          scene.result_of([&](const TetForceOp& body) { stages->tet_forces(body, 0, count); });

      EXPECT_TRUE(vectors == single) << stages->name << " " << count;
    }
  }
}

/// V (mu sum (s - 1)^2 + lambda / 2 (sum (s - 1))^2) of the singular values s of F, the least one
/// with the sign of det F.
TetSums energy_of(const TetShapes& tets, std::int64_t t) {
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) {
      edges(i, a) = tets.position[12 * t + 3 * (a + 1) + i] - tets.position[12 * t + i];
    }
  }
  const Eigen::Matrix3d gradient =
      Eigen::Map<const Eigen::Matrix3d>(tets.gradient.data + 9 * t).transpose();
  const Eigen::Matrix3d f = edges * gradient;
  Eigen::Array3d s = Eigen::JacobiSVD<Eigen::Matrix3d>(f).singularValues();
  if (f.determinant() < 0) s[2] = -s[2];
  const double trace = (s - 1).sum();
  return {
      tets.volume[t] * (tets.mu[t] * (s - 1).square().sum() + tets.lambda[t] / 2 * trace * trace),
      f.determinant() < 0 ? 1 : 0};
}

TEST(VectorStages, EnergiesAreThoseOfSingularValues) {
  for (const int count : {0, 1, 3, 8, 31, 1025}) {
    const TetScene scene(count);
    const TetShapes tets = scene.shapes();
    TetSums of_base;
    for (const VectorStages* stages : usable_stages()) {
      TetSums sum;
      for (std::int64_t t = 0; t < count; ++t) {
        const TetSums expected = energy_of(tets, t), one = stages->tet_energies(tets, t, t + 1);
        ASSERT_NEAR(one.energy, expected.energy, 1e-11 * (1 + expected.energy)) << t;
        const bool has_volume = t % 7 == 0 || t % 7 > 3;
        if (has_volume) {
          ASSERT_EQ(one.inverted, expected.inverted) << t;
        }
        sum.energy += one.energy;
        sum.inverted += one.inverted;
      }
      const TetSums all = stages->tet_energies(tets, 0, count);
      EXPECT_EQ(all.energy, sum.energy) << stages->name << " " << count;
      EXPECT_EQ(all.inverted, sum.inverted) << stages->name << " " << count;
      if (stages == &vector_stages_base) of_base = all;
      EXPECT_EQ(all.energy, of_base.energy) << stages->name << " " << count;
    }
  }
}

template <class T>
void expect_equal_products() {
  constexpr std::int32_t rows = 40;
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  std::vector<std::int32_t> start = {0}, free_end, column;
  for (std::int32_t row = 0; row < rows; ++row) {
    for (std::int32_t c = row % 3; c < rows; c += 1 + row % 5) column.push_back(c);
    start.push_back(static_cast<std::int32_t>(column.size()));
    free_end.push_back(start.back() - row % 2);
  }
  std::vector<T> values(9 * column.size() + 1), p(3 * rows), q(3 * rows), other(3 * rows);
  for (T& v : values) v = static_cast<T>(normal(random));
  for (T& v : p) v = static_cast<T>(normal(random));
  GradientArrays<T> a;
  a.rows.start = const_view(start);
  a.rows.free_end = const_view(free_end);
  a.rows.column = const_view(column);
  a.copy = const_view(values);
  a.p = view(p);
  a.q = view(q);
  double sum = 0;
  for (std::int64_t row = 0; row < rows; ++row) sum += a.multiply(row);
  a.q = view(other);
  for (const VectorStages* stages : usable_stages()) {
    double vectors = 0;
    if constexpr (sizeof(T) == sizeof(double)) {
      vectors = stages->product(a, 0, rows).value[0];
    } else {
      vectors = stages->product_float(a, 0, rows).value[0];
    }

    EXPECT_EQ(other, q) << stages->name;
    EXPECT_NEAR(vectors, sum, 1e-12 * std::abs(sum)) << stages->name;
  }
}

TEST(VectorStages, BlocksHaveTheBitsOfSingleSums) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr std::size_t parts = 7, places = 40;
  std::vector<float> rows(9 * parts), columns(8 * places), start(24);
  for (auto* values : {&rows, &columns, &start}) {
    for (float& own : *values) own = static_cast<float>(normal(random));
  }
  std::vector<std::int32_t> place;
  for (std::size_t p = 0; p < parts; ++p) place.push_back(static_cast<std::int32_t>(random() % 38));
  std::vector<float> expected = start;
  for (std::size_t p = 0; p < parts; ++p) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t n = 0; n < 24; ++n) {
        expected[n] += rows[9 * p + 3 * (n / 8) + i] *
                       columns[8 * (static_cast<std::size_t>(place[p]) + i) + n % 8];
      }
    }
  }
  for (const VectorStages* stages : usable_stages()) {
    std::vector<float> block = start;
    stages->add_blocks(rows.data(), place.data(), parts, columns.data(), block.data());
    EXPECT_EQ(block, expected) << stages->name;
  }
}

TEST(VectorStages, SumsOfRowsHaveTheBitsOfSingleNumbers) {
  constexpr std::int64_t size = 24, stride = 40;
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  std::vector<float> rows(3 * stride), start(size);
  for (auto* values : {&rows, &start}) {
    for (float& own : *values) own = static_cast<float>(normal(random));
  }
  const float change[3] = {0.3F, -2, 7};
  std::vector<float> expected = start;
  for (std::size_t k = 0; k < size; ++k) {
    for (std::size_t a = 0; a < 3; ++a) expected[k] += rows[a * stride + k] * change[a];
  }
  for (const VectorStages* stages : usable_stages()) {
    std::vector<float> sum = start;
    stages->add_rows_float(rows.data(), stride, change, size, sum.data());
    EXPECT_EQ(sum, expected) << stages->name;
  }
}

/// L L^T w = b of random blocks, against Eigen, on all instruction sets in the same bits.
TEST(VectorStages, SubstitutionSolves) {
  constexpr std::int32_t count = 30;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<std::int32_t> start{0}, row;
  std::vector<float> block, diagonal;
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  for (std::int32_t j = 0; j < count; ++j) {
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k <= i; ++k) {
        diagonal.push_back(static_cast<float>(i == k ? 1 + std::abs(normal(random)) : 0.3));
        inverse(i, k) = diagonal.back();
      }
    }
    lower.block<3, 3>(3 * j, 3 * j) = inverse.inverse();
    for (std::int32_t r = j + 1; r < count; r += 1 + j % 4) {
      row.push_back(r);
      for (int e = 0; e < 9; ++e) {
        block.push_back(static_cast<float>(0.1 * normal(random)));
        lower(3 * r + e % 3, 3 * j + e / 3) = block.back();
      }
    }
    start.push_back(static_cast<std::int32_t>(row.size()));
  }
  block.push_back(0);
  const Eigen::VectorXd load = Eigen::VectorXd::Random(3 * count);
  const Eigen::VectorXd exact = (lower * lower.transpose()).llt().solve(load);
  std::vector<double> first;
  for (const VectorStages* stages : usable_stages()) {
    std::vector<double> w(4 * count, 0.0), solved;
    for (std::size_t n = 0; n < 3 * count; ++n) w[n / 3 * 4 + n % 3] = load[static_cast<int>(n)];
    stages->substitute(
        {const_view(start), const_view(row), const_view(block), const_view(diagonal)}, w.data());
    for (std::size_t n = 0; n < 3 * count; ++n) {
      solved.push_back(w[n / 3 * 4 + n % 3]);
      EXPECT_NEAR(solved.back(), exact[static_cast<int>(n)], 1e-9 * exact.norm()) << stages->name;
    }
    if (first.empty()) first = solved;
    EXPECT_EQ(solved, first) << stages->name;
  }
}

/// BlockLu.ThreeVectorsAtOnceAreThreeVectors compares them with single vectors.
TEST(VectorStages, FourSubstitutionsHaveTheSameBitsInAllSets) {
  constexpr std::int32_t count = 33;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> row;
  for (std::int32_t j = 0; j < count; ++j) {
    for (std::int32_t r = j; r < count; r += 1 + j % 4) row.push_back(r);
    start.push_back(std::ssize(row));
  }
  std::vector<double> lower(12 * row.size()), upper(12 * row.size()), inverse(9 * count);
  for (auto* values : {&lower, &upper, &inverse}) {
    for (double& own : *values) own = 0.3 * normal(random);
  }
  std::vector<double> load(12 * count);
  for (std::size_t n = 0; n < load.size() / 2; ++n) load[load.size() - 1 - n] = normal(random);
  std::vector<double> first;
  for (const VectorStages* stages : usable_stages()) {
    std::vector<double> w = load;
    stages->substitute_four(
        {const_view(row), const_view(start), lower.data(), upper.data(), inverse.data()}, w.data());
    if (first.empty()) first = w;
    EXPECT_EQ(w, first) << stages->name;
    EXPECT_NE(w, load) << stages->name;
  }
}

TEST(VectorStages, ProductsOfBlocksHaveTheBitsOfSingleNumbers) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const std::vector<std::int32_t> rows{4, 0, 7, 5}, slot{2, -1, -1, -1, 0, 3, -1, 1};
  std::vector<double> blocks(12 * rows.size()), factor(12), start(12 * rows.size());
  for (auto* values : {&blocks, &factor, &start}) {
    for (double& own : *values) own = normal(random);
  }
  std::vector<double> expected = start;
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const double* const b = blocks.data() + 12 * e;
    double* const out = expected.data() + 12 * slot[static_cast<std::size_t>(rows[e])];
    for (int c = 0; c < 3; ++c) {
      for (int i = 0; i < 4; ++i) {
        out[4 * c + i] -= b[i] * factor[static_cast<std::size_t>(c)] +
                          b[4 + i] * factor[static_cast<std::size_t>(4 + c)] +
                          b[8 + i] * factor[static_cast<std::size_t>(8 + c)];
      }
    }
  }
  for (const VectorStages* stages : usable_stages()) {
    std::vector<double> out = start;
    stages->subtract_products(blocks.data(), rows.data(), std::ssize(rows), slot.data(),
                              factor.data(), out.data());
    EXPECT_EQ(out, expected) << stages->name;
  }
}

TEST(VectorStages, ProductsHaveTheBitsOfSingleRows) {
  expect_equal_products<double>();
  expect_equal_products<float>();
}

}  // namespace
}  // namespace tetwarp::test
