/// @file test_field_inverse.cpp
/// Inverses of displacement fields and splines: closed forms, positions that are images by
/// construction, and counts of those that are none.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <tetwarp/resample.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "host/warp/compose/field_inverse.hpp"

namespace tetwarp::test {
namespace {
using Matrix = std::array<Point3, 3>;  // rows

Point3 product(const Matrix& matrix, const Point3& x) {
  return {dot(matrix[0], x), dot(matrix[1], x), dot(matrix[2], x)};
}

/// Turned about the third axis, with different spacings.
Grid turned_grid(std::int64_t size) {
  Grid grid;
  grid.dims = {size, size, size};
  grid.origin = {3, -7, 11};
  grid.spacing = {0.5, 0.8, 1.1};
  grid.direction = {0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1};
  return grid;
}

Point3 center_of(const Grid& grid) {
  const double middle = 0.5 * static_cast<double>(grid.dims[0] - 1);
  return grid.world_of({middle, middle, middle});
}

/// x -> c + M (x - c) as displacements at the nodes of a grid. A cubic spline with these numbers as
/// coefficients is the same map, since it keeps linear functions.
template <class Number>
std::vector<Number> linear_displacement(const Grid& grid, const Matrix& matrix) {
  std::vector<Number> numbers;
  const Point3 center = center_of(grid);
  for (std::int64_t n = 0; n < grid.voxel_count(); ++n) {
    const Point3 x = minus(grid.world_of({static_cast<double>(n % grid.dims[0]),
                                          static_cast<double>(n / grid.dims[0] % grid.dims[1]),
                                          static_cast<double>(n / grid.dims[0] / grid.dims[1])}),
                           center);
    for (const double u : minus(product(matrix, x), x)) numbers.push_back(static_cast<Number>(u));
  }
  return numbers;
}

std::vector<Point3> random_points(const Grid& grid, double low, double high, std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(low, high);
  const auto last = static_cast<double>(grid.dims[0] - 1);
  std::vector<Point3> points;
  for (std::size_t p = 0; p < count; ++p) {
    points.push_back(
        grid.world_of({last * share(random), last * share(random), last * share(random)}));
  }
  return points;
}

double largest_distance(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  double largest = 0;
  for (std::size_t p = 0; p < a.size(); ++p) largest = std::max(largest, norm(minus(a[p], b[p])));
  return largest;
}

/// The fixed point x <- y - u(x) diverges for all of these.
const std::vector<Matrix> maps{
    {{{2.5, 0, 0}, {0, 2.5, 0}, {0, 0, 2.5}}},  // expansion
    {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}},       // rotation by 90 degrees
    {{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}},      // by 180 degrees
    {{{1, 3, 0}, {0, 1, 0}, {0, -2, 1}}},       // shear
    {{{0.3, 0, 0}, {0, 3, 0}, {0, 0, 1}}},      // along two axes, against each other
    {{{1.2, -0.9, 0.4}, {0.8, 0.7, -1.1}, {0.1, 1.3, 0.6}}}};

/// The inverse of a matrix, by Cramer's rule.
Matrix inverse_of(const Matrix& rows) {
  const Point3 a = cross(rows[1], rows[2]), b = cross(rows[2], rows[0]),
               c = cross(rows[0], rows[1]);
  const double determinant = dot(rows[0], a);
  Matrix inverse;
  for (std::size_t n = 0; n < 3; ++n) {
    inverse[n] = times(1 / determinant, {a[n], b[n], c[n]});
  }
  return inverse;
}

/// Whether a position is among the centers of a grid that is turned orthogonally, two voxels from
/// its rim.
bool is_within(const Grid& grid, const Point3& x) {
  const Point3 from = minus(x, grid.origin);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Point3 along{grid.direction[axis], grid.direction[3 + axis], grid.direction[6 + axis]};
    const double index = dot(along, from) / grid.spacing[axis];
    if (index < 2 || index > static_cast<double>(grid.dims[axis] - 3)) return false;
  }
  return true;
}

TEST(FieldInverse, OfLinearMapsIsTheInverseMatrix) {
  const Grid grid = turned_grid(21);
  const Point3 center = center_of(grid);
  for (std::size_t m = 0; m < maps.size(); ++m) {
    const std::array<Transform, 2> fields{
        DisplacementField{grid, linear_displacement<float>(grid, maps[m])},
        BSplineTransform{grid, linear_displacement<double>(grid, maps[m])}};
    for (const Transform& field : fields) {
      std::vector<Point3> points, images;
      for (const Point3& y : random_points(grid, 0.2, 0.8, 2000)) {
        const Point3 x = plus(center, product(inverse_of(maps[m]), minus(y, center)));
        if (!is_within(grid, x)) continue;
        points.push_back(x);
        images.push_back(y);
      }
      ASSERT_GT(points.size(), 300U) << m;

      const InverseResult result = FieldInverse(field).apply(images, 1);

      EXPECT_EQ(result.not_found.size(), 0U) << m;
      EXPECT_LE(result.largest_residual, 1e-6 * 0.5);
      EXPECT_LT(largest_distance(images, points), 1e-5) << m;  // displacements are float32
    }
  }
}

/// Also where the field folds, several times over.
TEST(FieldInverse, IsFoundForEveryImage) {
  std::mt19937 random(11);
  for (const double size : {0.1, 0.5, 2.0}) {
    const Grid grid = turned_grid(7);
    std::uniform_real_distribution<double> shift(-size, size);
    DisplacementField linear{grid, {}};
    BSplineTransform spline{grid, {}};
    for (std::int64_t n = 0; n < 3 * grid.voxel_count(); ++n) {
      linear.displacement.push_back(static_cast<float>(shift(random)));
      spline.coefficients.push_back(shift(random));
    }
    for (const Transform& field : std::array<Transform, 2>{linear, spline}) {
      const std::vector<Point3> images = transformed(field, random_points(grid, 0, 1, 2000));
      std::vector<Point3> found = images;

      const InverseResult result = FieldInverse(field).apply(found, 1);

      EXPECT_EQ(result.not_found.size(), 0U) << size << " " << field.index();
      EXPECT_LE(largest_distance(transformed(field, found), images), 1e-6 * 0.5);
    }
  }
}

/// Of more points than a thread takes at a time, a good part of them beyond the first search.
TEST(FieldInverse, HasTheSameBitsForAnyNumberOfThreads) {
  const Grid grid = turned_grid(9);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.25, 0.25);
  DisplacementField field{grid, {}};
  for (std::int64_t n = 0; n < 3 * grid.voxel_count(); ++n) {
    field.displacement.push_back(static_cast<float>(shift(random)));
  }
  const Transform transform = field;
  const std::vector<Point3> targets = random_points(grid, -0.1, 1.1, 17000);
  std::vector<Point3> one = targets, three = targets;
  const InverseResult result = FieldInverse(transform).apply(one, 1);
  FieldInverse again(transform);
  again.apply(three, 3);
  EXPECT_EQ(three, one);
  std::vector<Point3> second = targets;
  again.apply(second, 2);
  EXPECT_EQ(second, one);
  EXPECT_GT(result.not_found.size(), 0U);
  EXPECT_LT(result.not_found.size(), 10000U);
}

/// A position that is not finite is never found, and stays.
TEST(FieldInverse, LeavesPositionsThatAreNotFinite) {
  const Grid grid = turned_grid(9);
  const Transform field = DisplacementField{
      grid, std::vector<float>(3 * static_cast<std::size_t>(grid.voxel_count()), 0.1F)};
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Point3 center = center_of(grid);
  std::vector<Point3> points{center, {none, 0, 0}, {0, HUGE_VAL, 0}};

  const InverseResult result = FieldInverse(field).apply(points, 1);

  EXPECT_EQ(result.not_found, (std::vector<std::size_t>{1, 2}));
  EXPECT_NEAR(points[0][0], center[0] - 0.1F, 1e-6);
  EXPECT_EQ(points[2], (Point3{0, HUGE_VAL, 0}));
}

/// A shift by 3 voxels along i: what is within 3 voxels of the first face of the grid, which ends
/// half a voxel before the first center, is the image of nothing.
TEST(FieldInverse, CountsWhatNothingIsTakenToAndKeepsItsPlace) {
  Grid grid;
  grid.dims = {10, 6, 6};
  DisplacementField field{grid, {}};
  for (std::int64_t n = 0; n < grid.voxel_count(); ++n) {
    field.displacement.insert(field.displacement.end(), {3, 0, 0});
  }
  std::vector<Point3> points;
  for (int i = -4; i < 14; ++i) points.push_back({static_cast<double>(i), 2.3, 1.7});
  const std::vector<Point3> targets = points;
  const Transform transform = field;

  const InverseResult result = FieldInverse(transform).apply(points, 1);

  EXPECT_EQ(result.not_found.size(), 3U);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double i = targets[p][0];
    const double expected = i < -0.5 || i > 9.5 || i < 2.5 ? i : i - 3;  // beyond it nothing moves
    EXPECT_NEAR(points[p][0], expected, 1e-6) << i;
  }
}

/// All centers go to one plane, the half voxels around them to a slab of one voxel: of what lies in
/// the grid only that has an inverse.
TEST(FieldInverse, OfAMapThatIsSingularIsFoundInItsImageAlone) {
  Grid grid;
  grid.dims = {9, 9, 9};
  const Matrix flat{{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}};
  const Transform field = DisplacementField{grid, linear_displacement<float>(grid, flat)};
  std::vector<Point3> points{{3.2, 4.1, 4}, {3.2, 4.1, 4.75}, {1, 2, 7}, {6.5, 6.25, 3.6}};
  const std::vector<Point3> targets = points;

  EXPECT_EQ(FieldInverse(field).apply(points, 1).not_found, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(points[1], targets[1]);
  EXPECT_EQ(points[2], targets[2]);
}
}  // namespace
}  // namespace tetwarp::test
