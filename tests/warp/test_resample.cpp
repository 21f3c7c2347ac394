/// @file test_resample.cpp
/// Resampling by affine transforms and displacement fields: laws, the warp by a mesh of the same
/// map, borders.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/resample.hpp>

#include "host/base/index_space.hpp"
#include "host/base/point3.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
AffineTransform turned() {
  const double c = std::cos(0.3), s = std::sin(0.3);
  return {{c, -s, 0.1, s, c, 0, 0, 0.05, 1.1}, {3.2, -1.7, 0.6}};
}

Point3 at(const AffineTransform& affine, const Point3& x) {
  return transformed(affine, {x})[0];
}

/// The displacements of an affine transform on a grid.
DisplacementField field_of(const AffineTransform& affine, const Grid& grid) {
  DisplacementField field{grid, {}};
  for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
    for (std::int64_t j = 0; j < grid.dims[1]; ++j) {
      for (std::int64_t i = 0; i < grid.dims[0]; ++i) {
        const Point3 x =
            grid.world_of({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        for (const double u : minus(at(affine, x), x)) {
          field.displacement.push_back(static_cast<float>(u));
        }
      }
    }
  }
  return field;
}

DisplacementField shift_field(const Grid& grid, const Point3& shift) {
  return field_of({{1, 0, 0, 0, 1, 0, 0, 0, 1}, shift}, grid);
}

/// One cell of five tetrahedra that contains the grid, moved by the inverse map.
Volume by_mesh(const Volume& source, const AffineTransform& affine, const WarpOptions& options) {
  Mesh mesh = scenes::lattice({1, 1, 1}, {-300, -300, -300}, {300, 300, 300});
  const std::vector<Point3> deformed = mesh.rest_positions;
  mesh.rest_positions = transformed(affine, deformed);
  return warp(source, mesh, deformed, options).volume;
}

const std::array<std::array<std::int64_t, 3>, 7> sizes{
    {{1, 1, 1}, {1, 9, 5}, {7, 3, 4}, {8, 8, 8}, {9, 17, 3}, {31, 5, 6}, {33, 10, 9}}};

TEST(Resample, ByTheIdentityIsACopy) {
  for (const auto& dims : sizes) {
    for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::float32,
                                 PixelType::float64, PixelType::uint32, PixelType::int64}) {
      for (const int components : {1, 3}) {
        Grid grid = scenes::oblique_grid(dims[0], dims[1], dims[2]);
        const Volume source = scenes::wavy_volume(grid, type, components);
        const ResampleOptions options{.filter = type == PixelType::int64 ? Filter::nearest
                                                                         : Filter::linear};
        EXPECT_EQ(resample(source, shift_field(grid, {0, 0, 0}), options).data, source.data)
            << name_of(type) << dims[0];
      }
    }
  }
}

TEST(Resample, ByWholeVoxelsMovesSamplesAndFillsWithBackground) {
  const Grid grid = scenes::unit_grid(19, 11, 10);
  const Volume source = scenes::wavy_volume(grid, PixelType::int16);
  const Volume moved = resample(source, shift_field(grid, {2, -1, 3}), {.background = -7});
  const auto from = source.samples<std::int16_t>(), to = moved.samples<std::int16_t>();
  for (std::int64_t k = 0; k < 10; ++k) {
    for (std::int64_t j = 0; j < 11; ++j) {
      for (std::int64_t i = 0; i < 19; ++i) {
        const bool inside = i + 2 < 19 && j >= 1 && k + 3 < 10;
        const auto v = static_cast<std::size_t>((k * 11 + j) * 19 + i);
        const auto other = static_cast<std::size_t>(((k + 3) * 11 + j - 1) * 19 + i + 2);
        EXPECT_EQ(to[v], inside ? from[other] : -7);
      }
    }
  }
}

/// Positions of the warp are those of rounded nodes, and here of float32: 1e-4 voxel together.
TEST(Resample, EqualsTheWarpByAMeshOfTheSameMap) {
  const Grid grid = scenes::unit_grid(37, 29, 23);
  for (const PixelType type :
       {PixelType::uint8, PixelType::int16, PixelType::float32, PixelType::float64}) {
    const Volume source = scenes::wavy_volume(grid, type);
    const std::vector<double> samples = numbers_of(source);
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
    const double bound = 1e-3 * (*high - *low) + (is_integer(type) ? 1 : 0);
    for (const Filter filter : {Filter::linear, Filter::cubic, Filter::bspline, Filter::lanczos}) {
      const Volume truth = by_mesh(source, turned(), {.filter = filter, .background = *low});
      const ResampleOptions options{.filter = filter, .background = *low};
      EXPECT_LE(largest_difference(resample(source, turned(), options), truth), bound)
          << name_of(type) << name_of(filter);
      EXPECT_LE(largest_difference(resample(source, field_of(turned(), grid), options), truth),
                bound)
          << name_of(type) << name_of(filter);
    }
  }
}

/// A linear field is the same between the centers of any grid.
TEST(Resample, ByAFieldOnAnotherGridInterpolatesItLinearly) {
  const Grid grid = scenes::oblique_grid(21, 18, 15);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  Grid coarse = grid;
  coarse.dims = {9, 8, 7};
  for (double& spacing : coarse.spacing) spacing *= 3;
  coarse.origin = grid.world_of({-1, -1, -1});
  const ResampleOptions options{.background = -50};

  EXPECT_LT(largest_difference(resample(source, field_of(turned(), coarse), options),
                               resample(source, turned(), options)),
            0.02);
}

TEST(Resample, BeyondItsGridAFieldIsZeroOrBackground) {
  const Grid grid = scenes::unit_grid(24, 6, 5);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  Grid half = grid;
  half.dims[0] = 12;  // ends at 11.5
  const DisplacementField field = shift_field(half, {0, 1, 0});

  const Volume zero = resample(source, field, {.background = -9});
  const Volume background = resample(source, field, {.background = -9, .only_in_field = true});

  const auto s = source.samples<float>(), z = zero.samples<float>(),
             b = background.samples<float>();
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_EQ(z[i], i < 12 ? s[24 + i] : s[i]) << i;
    EXPECT_EQ(b[i], i < 12 ? s[24 + i] : -9) << i;
  }
  EXPECT_EQ(transformed(field, {{11.4, 2, 2}, {11.6, 2, 2}}),
            (std::vector<Point3>{{11.4, 3, 2}, {11.6, 2, 2}}));
}

TEST(Resample, OfDisplacementsThatAreNoNumbersOrHugeIsBackground) {
  const Grid grid = scenes::unit_grid(16, 4, 4);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  DisplacementField field = shift_field(grid, {0, 0, 0});
  field.displacement[3 * 5] = std::numeric_limits<float>::quiet_NaN();
  field.displacement[3 * 6 + 1] = std::numeric_limits<float>::infinity();
  field.displacement[3 * 7 + 2] = -1e30f;

  const Volume result = resample(source, field, {.background = 4});

  for (std::size_t i = 0; i < 16; ++i) {
    const bool is_bad = i >= 5 && i <= 7;
    EXPECT_EQ(result.samples<float>()[i], is_bad ? 4 : source.samples<float>()[i]) << i;
  }
}

TEST(Resample, HasTheSameBitsForAnyNumberOfThreads) {
  const Grid grid = scenes::unit_grid(33, 20, 19);
  const DisplacementField field = field_of(turned(), grid);
  for (const Filter filter : {Filter::nearest, Filter::linear, Filter::labels}) {
    const Volume source = scenes::wavy_volume(grid, PixelType::uint16);
    const Volume one = resample(source, field, {.filter = filter, .threads = 1});
    EXPECT_EQ(resample(source, field, {.filter = filter, .threads = 3}).data, one.data);
  }
}

TEST(Resample, NamesBadArguments) {
  const Grid grid = scenes::unit_grid(4, 4, 4);
  const Volume source = scenes::wavy_volume(grid, PixelType::int64);
  const auto message = [&](const Transform& transform, const ResampleOptions& options) {
    return message_of<std::invalid_argument>([&] { resample(source, transform, options); });
  };
  DisplacementField short_field = shift_field(grid, {0, 0, 0});
  short_field.displacement.pop_back();
  AffineTransform infinite;
  infinite.offset[1] = std::numeric_limits<double>::infinity();

  EXPECT_NE(message(short_field, {.filter = Filter::nearest}).find("three numbers"),
            std::string::npos);
  EXPECT_NE(message(infinite, {.filter = Filter::nearest}).find("is not finite"),
            std::string::npos);
  EXPECT_NE(message(AffineTransform{}, {.filter = Filter::linear}), "");
  EXPECT_NE(message(AffineTransform{}, {.filter = Filter::nearest, .output_grid = Grid{}}), "");
}

/// Coefficients a + b x make the spline a + b x; beyond the inner knots it moves nothing.
TEST(Resample, BySplinesIsLinearForLinearCoefficients) {
  BSplineTransform spline{scenes::oblique_grid(6, 5, 7), {}};
  const DisplacementField linear = field_of(turned(), spline.grid);
  spline.coefficients.assign(linear.displacement.begin(), linear.displacement.end());
  const auto moved = [&](const Point3& index) {
    const Point3 x = spline.grid.world_of(index);
    return norm(minus(transformed(spline, {x})[0], at(turned(), x)));
  };
  for (const Point3& index : {Point3{1, 1, 1}, {4, 3, 5}, {2.3, 1.9, 4.7}, {3, 2, 1.0001}}) {
    EXPECT_LT(moved(index), 1e-5);
  }
  for (const Point3& index : {Point3{0.999, 2, 2}, {2, 3.001, 2}, {2, 2, 6}}) {
    const Point3 x = spline.grid.world_of(index);
    EXPECT_EQ(transformed(spline, {x})[0], x);
  }
}

/// The definition: products of cubic B-splines around their knots.
TEST(Resample, BySplinesSumsTheBasis) {
  BSplineTransform spline{scenes::unit_grid(7, 6, 8), {}};
  for (std::uint64_t n = 0; n < 3 * 7 * 6 * 8; ++n) {
    spline.coefficients.push_back(scenes::uniform(5, n) - 0.5);
  }
  const auto basis = [](double x) {
    const double t = std::abs(x);
    if (t < 1) return 2.0 / 3 - t * t + t * t * t / 2;
    return t < 2 ? (2 - t) * (2 - t) * (2 - t) / 6 : 0.0;
  };
  const Point3 x{2.7, 3.4, 5.1};
  Point3 sum = x;
  for (std::size_t n = 0; n < 7 * 6 * 8; ++n) {
    const double weight = basis(x[0] - static_cast<double>(n % 7)) *
                          basis(x[1] - static_cast<double>(n / 7 % 6)) *
                          basis(x[2] - static_cast<double>(n / 42));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sum[axis] += weight * spline.coefficients[3 * n + axis];
    }
  }
  EXPECT_LT(norm(minus(transformed(spline, {x})[0], sum)), 1e-14);
}

/// Linear interpolation in float64 at the points to which transformed() takes the voxels: weights
/// and vectors in float32 are within 2^-20 voxel here.
TEST(Resample, TakesSamplesWhereThePointsGo) {
  const Grid grid = scenes::oblique_grid(29, 13, 11);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  const auto samples = source.samples<float>();
  Grid coarse = grid;
  coarse.dims = {10, 6, 5};
  for (double& spacing : coarse.spacing) spacing *= 3.1;
  BSplineTransform spline{coarse, {}};
  for (std::uint64_t n = 0; n < 3 * 10 * 6 * 5; ++n) {
    spline.coefficients.push_back(4 * scenes::uniform(3, n) - 2);
  }
  const AffineTransform other{{1, 0.1, 0, 0, 0.9, 0, 0.05, 0, 1}, {-1, 2, 0.5}}, still;
  const DisplacementField field = field_of(other, coarse), same = field_of(other, grid);
  const std::vector<Transform> transforms{field,
                                          spline,
                                          TransformChain{{other, still, field}},
                                          TransformChain{{field, other}},
                                          TransformChain{{same, spline}},
                                          TransformChain{{still, other, still}}};
  const IndexFromWorld to_index = index_from_world(grid);
  std::int64_t compared = 0;
  for (std::size_t t = 0; t < transforms.size(); ++t) {
    const Volume result = resample(source, transforms[t], {.background = -50});
    for (std::int64_t v = 0; v < grid.voxel_count(); ++v) {
      const Point3 voxel{static_cast<double>(v % 29), static_cast<double>(v / 29 % 13),
                         static_cast<double>(v / (29 * 13))};
      const Point3 x = transformed(transforms[t], {grid.world_of(voxel)})[0];
      std::int64_t low[3];
      double fraction[3], expected = 0;
      bool is_inner = true;
      for (int axis = 0; axis < 3; ++axis) {
        double index = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          index += to_index.linear[axis][c] * (x[c] - to_index.origin[c]);
        }
        const double last = static_cast<double>(grid.dims[static_cast<std::size_t>(axis)] - 1);
        is_inner = is_inner && index > 0 && index < last;
        low[axis] = static_cast<std::int64_t>(std::floor(index));
        fraction[axis] = index - std::floor(index);
      }
      if (!is_inner) continue;
      for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        std::int64_t place[3];
        for (int axis = 0; axis < 3; ++axis) {
          const bool is_upper = (corner >> axis & 1) != 0;
          weight *= is_upper ? fraction[axis] : 1 - fraction[axis];
          place[axis] = low[axis] + (is_upper ? 1 : 0);
        }
        expected +=
            weight *
            static_cast<double>(
                samples[static_cast<std::size_t>((place[2] * 13 + place[1]) * 29 + place[0])]);
      }
      ASSERT_NEAR(result.samples<float>()[static_cast<std::size_t>(v)], expected, 1e-3)
          << t << ' ' << v;
      ++compared;
    }
  }
  EXPECT_GT(compared, 6 * 1000);
}

/// Links that cancel or move nothing leave the samples' bits alone.
TEST(Resample, ByLinksThatMoveNothingIsACopy) {
  const Grid grid = scenes::oblique_grid(17, 9, 8);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  const AffineTransform still, twice{{2, 0, 0, 0, 2, 0, 0, 0, 2}, {0, 0, 0}},
      half{{0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5}, {0, 0, 0}};
  EXPECT_EQ(resample(source, still).data, source.data);
  EXPECT_EQ(resample(source, TransformChain{{still, still}}).data, source.data);
  EXPECT_EQ(resample(source, TransformChain{{twice, half}}).data, source.data);
}

TEST(Resample, ByAChainAppliesItsLinksInTurn) {
  const Grid grid = scenes::oblique_grid(23, 18, 15);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  AffineTransform other{{1, 0.1, 0, 0, 0.9, 0, 0.05, 0, 1}, {-1, 2, 0.5}};
  const TransformChain chain{{turned(), other}};
  AffineTransform both;
  for (std::size_t row = 0; row < 3; ++row) {
    both.offset[row] = other.offset[row];
    for (std::size_t n = 0; n < 3; ++n) {
      both.offset[row] += other.matrix[3 * row + n] * turned().offset[n];
      both.matrix[3 * row + n] = 0;
      for (std::size_t m = 0; m < 3; ++m) {
        both.matrix[3 * row + n] += other.matrix[3 * row + m] * turned().matrix[3 * m + n];
      }
    }
  }
  const ResampleOptions options{.background = -50};
  EXPECT_LT(largest_difference(resample(source, chain, options), resample(source, both, options)),
            1e-3);
  Volume wide = make_volume(grid, PixelType::float64);
  std::ranges::copy(numbers_of(source), wide.samples<double>().begin());
  EXPECT_LT(largest_difference(resample(wide, chain, options), resample(wide, both, options)),
            1e-9);
  EXPECT_EQ(message_of([&] { resample(source, TransformChain{}); }),
            "transform: a chain without links");
}
}  // namespace
}  // namespace tetwarp::test
