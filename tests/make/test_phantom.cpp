/// @file test_phantom.cpp
/// The phantom: range, organs, edges, and lattices around it under every deformation.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tetwarp/make.hpp>

#include "tests/support/make_checks.hpp"

namespace tetwarp {
namespace {
using make_checks::lattice_of;
using make_checks::smallest_volume;

constexpr std::array<Deformation, 6> all_deformations{Deformation::twist,  Deformation::bend,
                                                      Deformation::swim,   Deformation::random,
                                                      Deformation::rotate, Deformation::translate};

const Volume& phantom() {
  static const Volume volume = make_phantom();
  return volume;
}

/// Mean of a cube of 5 x 5 x 3 voxels around a world position.
double mean_near(const Volume& volume, const Point3& x) {
  const Grid& grid = volume.grid;
  std::array<std::int64_t, 3> at;
  for (std::size_t d = 0; d < 3; ++d) {
    at[d] = static_cast<std::int64_t>(std::lround((x[d] - grid.origin[d]) / grid.spacing[d]));
  }
  double sum = 0;
  for (std::int64_t k = at[2] - 1; k <= at[2] + 1; ++k) {
    for (std::int64_t j = at[1] - 2; j <= at[1] + 2; ++j) {
      for (std::int64_t i = at[0] - 2; i <= at[0] + 2; ++i) {
        const std::int64_t voxel = (k * grid.dims[1] + j) * grid.dims[0] + i;
        sum += static_cast<double>(volume.samples<float>()[static_cast<std::size_t>(voxel)]);
      }
    }
  }
  return sum / (5 * 5 * 3);
}

TEST(Phantom, IsInRangeAndZeroAround) {
  const auto samples = phantom().samples<float>();
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
  EXPECT_EQ(*low, 0.0f);
  EXPECT_LE(*high, 1.0f);
  EXPECT_GT(*high, 0.9f);
  const auto outside = std::count(samples.begin(), samples.end(), 0.0f);
  const double share = static_cast<double>(outside) / static_cast<double>(samples.size());
  EXPECT_GT(share, 0.3);
  EXPECT_LT(share, 0.7);
  const auto& dims = phantom().grid.dims;
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i) {
        const bool is_border =
            i == 0 || j == 0 || k == 0 || i == dims[0] - 1 || j == dims[1] - 1 || k == dims[2] - 1;
        if (!is_border) continue;
        ASSERT_EQ(samples[static_cast<std::size_t>((k * dims[1] + j) * dims[0] + i)], 0.0f);
      }
    }
  }
}

TEST(Phantom, HasItsOrgansWhereTheyBelong) {
  const double lung_right = mean_near(phantom(), {-105, 10, 30});
  const double lung_left = mean_near(phantom(), {105, 10, 30});
  EXPECT_NEAR(lung_right, 0.13, 0.03);
  EXPECT_NEAR(lung_left, 0.13, 0.03);
  EXPECT_NEAR(mean_near(phantom(), {-70, -30, -40}), 0.55, 0.05);  // liver, on the right
  EXPECT_NEAR(mean_near(phantom(), {34, -16, 6}), 0.94, 0.05);     // left ventricle
  EXPECT_NEAR(mean_near(phantom(), {0, 47, -74}), 0.54, 0.06);     // a vertebra, at the back
  EXPECT_NEAR(mean_near(phantom(), {0, 23, 120}), 0.04, 0.02);     // the windpipe
  EXPECT_NEAR(mean_near(phantom(), {75, 42, -87}), 0.74, 0.06);    // left kidney
  EXPECT_EQ(mean_near(phantom(), {0, 115, 0}), 0);                 // behind the back
}

TEST(Phantom, EdgesAreSoft) {
  // Rows from the air at the body's right side inwards: in at least three quarters of them the
  // first voxel of the body is a partial one.
  const auto samples = phantom().samples<float>();
  const Grid& grid = phantom().grid;
  int entries = 0;
  int partial = 0;
  for (std::int64_t j = 60; j < 100; ++j) {
    const auto row = static_cast<std::size_t>((60 * grid.dims[1] + j) * grid.dims[0]);
    std::size_t i = 0;
    while (samples[row + i] == 0) ++i;
    ++entries;
    partial += samples[row + i] < 0.36f;
  }
  EXPECT_GE(4 * partial, 3 * entries);
}

TEST(Phantom, IsTheSameEveryTimeAndForEveryResolutionTheSameBody) {
  const Volume again = make_phantom();
  EXPECT_EQ(again.data, phantom().data);
  const Volume coarse = make_phantom({128, 80, 61});
  EXPECT_DOUBLE_EQ(coarse.grid.spacing[0], 3);
  const auto mass = [](const Volume& volume) {
    double sum = 0;
    for (const float sample : volume.samples<float>()) sum += static_cast<double>(sample);
    return sum / static_cast<double>(volume.grid.voxel_count());
  };
  EXPECT_NEAR(mass(coarse), mass(phantom()), 0.02 * mass(phantom()));
  EXPECT_THROW(make_phantom({0, 4, 4}), std::invalid_argument);
}

TEST(Phantom, EveryDeformationKeepsItsLatticeRightSideOut) {
  for (const int cells : {6, 8, 10}) {
    for (const Mesh& mesh : {lattice_of(phantom(), cells), lattice_of(phantom(), cells, 0.02)}) {
      for (const Deformation kind : all_deformations) {
        for (int axis = 0; axis < 3; ++axis) {
          for (const double time : {0.25, 0.5, 1.0}) {
            const auto positions = deform_positions(mesh, {.kind = kind, .axis = axis}, time);
            EXPECT_GT(smallest_volume(mesh, positions), 0)
                << name_of(kind) << " axis " << axis << " time " << time << " cells " << cells;
          }
        }
      }
    }
  }
}

TEST(Phantom, SixCellsMakeTheLatticeOfTheBenchmarks) {
  EXPECT_EQ(lattice_of(phantom(), 6).tets.size(), 720u);
}
}  // namespace
}  // namespace tetwarp
