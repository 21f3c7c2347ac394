/// @file test_row_vectors.cpp
/// The rows that the cpu back end computes in vectors hold, for every vector instruction set of the
/// processor, the bits of the functions of one voxel in kernels/warp.
#include <gtest/gtest.h>

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <tetwarp/resample.hpp>

#include "host/base/pixel_dispatch.hpp"
#include "tests/support/hex_scenes.hpp"
#include "tests/support/row_bench.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
/// The instruction sets of this processor for which the library is compiled.
std::vector<std::int64_t> instruction_sets() {
  std::vector<std::int64_t> sets;
  const std::int64_t compiled = HWY_TARGETS & ~HWY_SSE4;
  for (std::int64_t left = hwy::SupportedTargets() & compiled; left != 0; left &= left - 1) {
    sets.push_back(left & -left);
  }
  return sets;
}

/// Lets the dispatch of the library use one instruction set only, until the end of the scope.
class OnlySet {
 public:
  explicit OnlySet(std::int64_t set) {
    hwy::SetSupportedTargetsForTest(set);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  ~OnlySet() {
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  OnlySet(const OnlySet&) = delete;
  OnlySet& operator=(const OnlySet&) = delete;
};

/// Equal bits; any NaN equals any other.
template <class T>
bool has_equal_bits(const T& a, const T& b) {
  if constexpr (std::is_floating_point_v<T>) {
    if (a != a && b != b) return true;
  }
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

void expect_bits_of_one_voxel(const RowCase& what) {
  with_pixel_type(what.type, [&]<class T>(T) {
    RowBench<T> bench(what);
    for (const std::int64_t set : instruction_sets()) {
      const OnlySet only(set);
      const std::vector<T> rows = bench.by_rows();
      const std::vector<T> voxels = bench.by_voxels();
      const bool is_same = std::equal(rows.begin(), rows.end(), voxels.begin(), has_equal_bits<T>);
      EXPECT_TRUE(is_same) << what << ", " << hwy::TargetName(set);
    }
    EXPECT_EQ(bench.covered() > 0, what.row != 0) << what;
  });
}

constexpr std::array transformed_types = {PixelType::uint8,   PixelType::int8,   PixelType::uint16,
                                          PixelType::int16,   PixelType::uint32, PixelType::int32,
                                          PixelType::float32, PixelType::float64};
constexpr std::array label_types = {PixelType::uint8,  PixelType::int8,   PixelType::uint16,
                                    PixelType::int16,  PixelType::uint32, PixelType::int32,
                                    PixelType::uint64, PixelType::int64};

TEST(RowVectors, DensitiesHaveTheBitsOfOneVoxel) {
  for (const PixelType type : transformed_types) {
    for (const int components : {1, 2, 5, 9}) {
      expect_bits_of_one_voxel({.type = type, .components = components});
    }
  }
}

TEST(RowVectors, MeansHaveTheBitsOfOneVoxel) {
  for (const PixelType type : transformed_types) {
    expect_bits_of_one_voxel({.type = type, .averages = true});
    expect_bits_of_one_voxel({.type = type, .components = 4, .averages = true, .clamps = true});
  }
  expect_bits_of_one_voxel({.filter = Filter::nearest, .averages = true});
}

TEST(RowVectors, TurnedVectorsAndTensorsHaveTheBitsOfOneVoxel) {
  for (const PixelType type : transformed_types) {
    expect_bits_of_one_voxel({.type = type, .components = 3, .reorientation = Quantity::vector});
    expect_bits_of_one_voxel({.type = type, .components = 6, .reorientation = Quantity::tensor});
    expect_bits_of_one_voxel(
        {.type = type, .components = 6, .reorientation = Quantity::principal_tensor});
  }
  for (const Filter filter : {Filter::nearest, Filter::cubic}) {
    expect_bits_of_one_voxel(
        {.components = 3, .filter = filter, .reorientation = Quantity::covariant_vector});
    expect_bits_of_one_voxel(
        {.components = 6, .filter = filter, .reorientation = Quantity::tensor});
  }
  expect_bits_of_one_voxel({.components = 3,
                            .reorientation = Quantity::contravariant_vector,
                            .averages = true,
                            .clamps = true});
  expect_bits_of_one_voxel({.components = 6, .reorientation = Quantity::tensor, .averages = true});
  expect_bits_of_one_voxel({.components = 6,
                            .reorientation = Quantity::principal_tensor,
                            .averages = true,
                            .clamps = true});
  expect_bits_of_one_voxel(
      {.components = 6, .reorientation = Quantity::principal_tensor, .has_special = true});
}

TEST(RowVectors, TransformsHaveTheBitsOfOneVoxelInEveryScene) {
  for (const std::string_view scene : scenes::adversarial_names) {
    expect_bits_of_one_voxel({.scene = std::string(scene), .averages = true});
    expect_bits_of_one_voxel({.scene = std::string(scene),
                              .components = 3,
                              .reorientation = Quantity::vector,
                              .has_special = true});
  }
}

TEST(RowVectors, LabelsHaveTheBitsOfOneVoxel) {
  for (const PixelType type : label_types) {
    for (const std::string_view scene : scenes::adversarial_names) {
      expect_bits_of_one_voxel(
          {.scene = std::string(scene), .type = type, .filter = Filter::labels});
    }
  }
}

/// Every instruction set gives the same bits, at the borders of the source and in folded cells,
/// too; wider numbers, whose voxels are computed one by one, the same values.
TEST(RowVectors, HexahedraHaveTheBitsOfEveryInstructionSet) {
  constexpr std::int64_t edge = 20;
  for (const double amount : {0.05, 2.0, 9.0}) {
    const HexBox box =
        hex_box({3, 2, 3}, {-2.5, -1.5, 0.5}, {edge + 1.5, edge - 0.5, edge - 2.5}, bent(amount));
    const Grid grid = scenes::unit_grid(edge, edge - 3, edge + 2);
    const scenes::Scene scene{"hexahedra", box.mesh, box.deformed, grid, grid};
    for (const PixelType type : {PixelType::float32, PixelType::uint8, PixelType::int16}) {
      for (const int components : {1, 3}) {
        for (const Filter filter : {Filter::linear, Filter::nearest}) {
          const Volume source = scenes::wavy_volume(grid, type, components);
          const WarpOptions options{.filter = filter};
          const Warped whole = run_warp(source, scene, Backend::cpu, options);
          for (const std::int64_t set : instruction_sets()) {
            const OnlySet only(set);
            const Warped one = run_warp(source, scene, Backend::cpu, options);
            EXPECT_TRUE(one.volume.data == whole.volume.data) << hwy::TargetName(set);
          }
          if (type != PixelType::float32 || filter != Filter::linear || amount > 2) continue;
          Volume wide = make_volume(grid, PixelType::float64, components);
          const auto from = source.samples<float>();
          std::copy(from.begin(), from.end(), wide.samples<double>().begin());
          const Warped judge = run_warp(wide, scene, Backend::cpu, options);
          EXPECT_LE(largest_difference(whole.volume, judge.volume), 1e-5);
        }
      }
    }
  }
}

/// Sources thinner than a vector, of which all samples are at an end, and lengths around widths.
TEST(RowVectors, SmallSourcesHaveTheBitsOfOneVoxel) {
  for (const std::array<std::int64_t, 3> dims : {std::array<std::int64_t, 3>{1, 1, 1},
                                                 {2, 1, 1},
                                                 {1, 2, 9},
                                                 {31, 1, 2},
                                                 {32, 3, 1},
                                                 {33, 20, 2},
                                                 {1025, 2, 2}}) {
    for (const char* scene : {"rotated", "waved"}) {
      for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::uint32}) {
        expect_bits_of_one_voxel(
            {.scene = scene, .type = type, .filter = Filter::labels, .dims = dims});
        expect_bits_of_one_voxel({.scene = scene, .type = type, .averages = true, .dims = dims});
      }
      for (const PixelType type : {PixelType::float32, PixelType::float64, PixelType::uint8}) {
        expect_bits_of_one_voxel({.scene = scene,
                                  .type = type,
                                  .components = 3,
                                  .reorientation = Quantity::vector,
                                  .dims = dims});
      }
    }
  }
}

TEST(RowVectors, RowsOfAnyLengthHaveTheBitsOfOneVoxel) {
  for (const std::int64_t row : tricky_sizes) {
    for (const PixelType type : {PixelType::uint8, PixelType::int32}) {
      expect_bits_of_one_voxel({.type = type, .filter = Filter::labels, .row = row});
      expect_bits_of_one_voxel({.type = type, .averages = true, .row = row});
    }
    expect_bits_of_one_voxel({.row = row});
    expect_bits_of_one_voxel({.components = 3, .reorientation = Quantity::vector, .row = row});
    expect_bits_of_one_voxel(
        {.components = 6, .reorientation = Quantity::principal_tensor, .row = row});
  }
}

TEST(RowVectors, RegionsHaveTheBitsOfOneVoxel) {
  for (const Region& region : {Region{{3, 5, 1}, {20, 16, 19}}, Region{{9, 0, 7}, {10, 17, 8}}}) {
    expect_bits_of_one_voxel({.averages = true, .region = region});
    expect_bits_of_one_voxel(
        {.components = 6, .reorientation = Quantity::tensor, .averages = true, .region = region});
    expect_bits_of_one_voxel(
        {.type = PixelType::uint8, .filter = Filter::labels, .region = region});
  }
}

/// Eights of voxels that lie on a field's voxels, between them, beyond the field or in several of
/// these ways: a voxel has the same bits whatever row and instruction set it is computed in.
TEST(RowVectors, ChainsOfFieldsHaveTheBitsOfEveryRowAndInstructionSet) {
  const Grid grid = scenes::unit_grid(23, 9, 7);
  Grid turned = grid;
  turned.origin = {16, -3.25, 1};  // all positions are exact: rows round to no other ones
  turned.spacing = {0.5, 2, 1};
  turned.direction = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  const auto field_on = [](const Grid& on, std::uint64_t seed) {
    DisplacementField field{on, std::vector<float>(3 * static_cast<std::size_t>(on.voxel_count()))};
    for (std::size_t n = 0; n < field.displacement.size(); ++n) {
      const double x = scenes::uniform(seed, n);
      field.displacement[n] = x < 0.9 ? 0.0f : static_cast<float>(std::floor(40 * x - 38)) / 4;
      if (x > 0.999) field.displacement[n] = std::numeric_limits<float>::quiet_NaN();
    }
    return field;
  };
  Grid between = grid;
  between.origin = {0.25, 0.5, 0.25};
  const auto noise_on = [](const Grid& on, std::uint64_t seed) {
    DisplacementField field{on, std::vector<float>(3 * static_cast<std::size_t>(on.voxel_count()))};
    for (std::size_t n = 0; n < field.displacement.size(); ++n) {
      field.displacement[n] = static_cast<float>(std::floor(9 * scenes::uniform(seed, n)) - 4) / 4;
      if (n % 997 == 5) field.displacement[n] = std::numeric_limits<float>::quiet_NaN();
    }
    return field;
  };
  const TransformChain chains[] = {{{field_on(grid, 1), field_on(grid, 2)}},
                                   {{noise_on(between, 6), field_on(grid, 7)}},
                                   {{field_on(between, 8), noise_on(between, 9)}},
                                   {{field_on(turned, 3), field_on(grid, 4), field_on(turned, 5)}}};
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  for (const TransformChain& chain : chains) {
    const auto samples_of = [&](std::int64_t row) {
      ResampleOptions options{.background = -9, .output_grid = grid, .threads = 1};
      options.output_grid->dims[0] = row;
      return resample(source, chain, options);
    };
    const Volume expected = samples_of(23);
    for (const std::int64_t set : instruction_sets()) {
      const OnlySet only(set);
      for (std::int64_t row = 8; row <= 23; ++row) {
        const Volume found = samples_of(row);
        for (std::int64_t v = 0; v < found.grid.voxel_count(); ++v) {
          const auto same = static_cast<std::size_t>(v / row * 23 + v % row);
          ASSERT_TRUE(has_equal_bits(found.samples<float>()[static_cast<std::size_t>(v)],
                                     expected.samples<float>()[same]))
              << hwy::TargetName(set) << " row of " << row << ", voxel " << v;
        }
      }
    }
    EXPECT_NE(std::ranges::count(expected.samples<float>(), -9.0f), expected.grid.voxel_count());
  }
}
}  // namespace
}  // namespace tetwarp::test
