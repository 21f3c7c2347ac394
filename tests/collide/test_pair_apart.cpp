/// @file test_pair_apart.cpp
/// Directions along which triangles stay apart, against distances of their features at many times.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "host/base/point3.hpp"
#include "host/base/vector_view.hpp"
#include "kernels/collide/pair_apart.hpp"

namespace tetwarp::test {
namespace {

/// Two triangles; corners from 3 on are those of the second one that the first does not have.
struct Triangles {
  std::array<std::int32_t, 3> a{0, 1, 2}, b{};
  std::vector<double> start, end;

  MotionView motion(const std::vector<double>& sagitta) const {
    return {view_of(start), view_of(end), view_of(sagitta), {}, {}, {}};
  }
};

class PairApart : public testing::TestWithParam<bool> {
 protected:
  /// @param b  corners of the second triangle
  Triangles make(const std::array<std::int32_t, 3>& b) {
    Triangles all;
    all.b = b;
    for (std::int32_t v = 0; v < 6; ++v) {
      const double shift = v < 3 ? 0 : 1.5;
      for (int i = 0; i < 3; ++i) {
        const double x = (i == 2 ? 0.2 : 1.0) * normal_(random_) + (i == 0 ? shift : 0);
        all.start.push_back(x);
        all.end.push_back(x + 0.2 * normal_(random_));
      }
    }
    return all;
  }

  static bool has(const std::array<std::int32_t, 3>& corners, std::int32_t v) {
    return std::ranges::find(corners, v) != corners.end();
  }
  /// The smallest distance of features that share no corner, at a time.
  static double distance_at(const Triangles& all, double time) {
    std::vector<Point3> x(6);
    for (std::size_t v = 0; v < 6; ++v) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t k = 3 * v + i;
        x[v][i] = all.start[k] + time * (all.end[k] - all.start[k]);
      }
    }
    const auto at = [&](std::int32_t v) { return x[static_cast<std::size_t>(v)].data(); };
    double least = 1e9, weight[3], s = 0, t = 0;
    for (const auto& [face, other] : {std::pair(all.a, all.b), std::pair(all.b, all.a)}) {
      for (const std::int32_t v : other) {
        if (has(face, v)) continue;
        least = std::min(
            least, vertex_face_distance(at(v), at(face[0]), at(face[1]), at(face[2]), weight));
      }
    }
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t l = 0; l < 3; ++l) {
        const std::int32_t p = all.a[k], q = all.a[(k + 1) % 3], r = all.b[l],
                           u = all.b[(l + 1) % 3];
        if (p == r || p == u || q == r || q == u) continue;
        least = std::min(least, edge_edge_distance(at(p), at(q), at(r), at(u), &s, &t));
      }
    }
    return least;
  }

  static CollideItem item_of(const std::array<std::int32_t, 3>& corners) {
    CollideItem item{};
    std::ranges::copy(corners, item.vertex);
    item.count = 3;
    return item;
  }

 private:
  std::mt19937 random_{3};
  std::normal_distribution<double> normal_;
};

/// Triangles with no common corner, and with one.
TEST_P(PairApart, TrianglesThatAreFoundApartAreSoAllTheTime) {
  const bool share = GetParam();
  const std::vector<double> radius(6, 0.0), sagitta(6, 0.0);
  int found = 0, apart = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Triangles all = make(share ? std::array{4, 2, 5} : std::array{3, 4, 5});
    const double distance = 0.02;
    const ItemPoints a(item_of(all.a), all.motion(sagitta), view_of(radius), all.start.data());
    const ItemPoints b(item_of(all.b), all.motion(sagitta), view_of(radius), all.start.data());
    const bool is_apart = share ? fans_apart(a, 2, b, 1, distance) : middles_apart(a, b, distance);
    double least = 1e9;
    for (int step = 0; step <= 20; ++step) least = std::min(least, distance_at(all, step / 20.0));
    found += is_apart ? 1 : 0;
    apart += least > distance ? 1 : 0;
    ASSERT_TRUE(!is_apart || least > distance) << least;
  }
  EXPECT_GT(found, apart / 4) << "of " << apart;
}

INSTANTIATE_TEST_SUITE_P(Corners, PairApart, testing::Bool());

}  // namespace
}  // namespace tetwarp::test
