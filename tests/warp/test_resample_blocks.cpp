/// @file test_resample_blocks.cpp
/// Resampling in parts, with windows of source and fields: the bits of the whole, for every size of
/// a part.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <tetwarp/resample.hpp>

#include "host/base/region_grid.hpp"
#include "host/warp/resample_blocks.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
/// A voxel of `size` bytes of a region, voxel by voxel of the region.
std::vector<std::byte> cut(const std::byte* data,
                           const Grid& grid,
                           const Region& region,
                           std::size_t size) {
  std::vector<std::byte> part;
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
      const std::int64_t row = grid.dims[0] * (j + grid.dims[1] * k);
      const std::byte* const from = data + size * static_cast<std::size_t>(row + region.begin[0]);
      const std::byte* const to = data + size * static_cast<std::size_t>(row + region.end[0]);
      part.insert(part.end(), from, to);
    }
  }
  return part;
}

/// Random vectors of up to `size` along each axis.
template <class Number>
std::vector<Number> vectors_on(const Grid& grid, double size, std::uint64_t seed) {
  std::vector<Number> vectors(3 * static_cast<std::size_t>(grid.voxel_count()));
  for (std::size_t n = 0; n < vectors.size(); ++n) {
    vectors[n] = static_cast<Number>(size * (2 * scenes::uniform(seed, n) - 1));
  }
  return vectors;
}

Grid coarser(Grid grid, double factor) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.dims[axis] = std::max<std::int64_t>(4, std::llround(double(grid.dims[axis]) / factor));
    grid.spacing[axis] *= factor;
  }
  return grid;
}

/// Readers of a transform's fields that cut windows out of memory.
std::vector<FieldReader> readers_of(const Transform& transform) {
  std::vector<FieldReader> readers;
  const auto add = [&](const auto& single) {
    FieldReader reader;
    if constexpr (std::is_same_v<std::decay_t<decltype(single)>, DisplacementField>) {
      reader.read = [&single](const Region& region, float* out) {
        const std::vector<std::byte> part =
            cut(reinterpret_cast<const std::byte*>(single.displacement.data()), single.grid, region,
                3 * sizeof(float));
        std::memcpy(out, part.data(), part.size());
      };
    }
    readers.push_back(reader);
  };
  if (const auto* const chain = std::get_if<TransformChain>(&transform)) {
    for (const SingleTransform& link : chain->links) std::visit(add, link);
  } else {
    std::visit(add, transform);
  }
  return readers;
}

/// The whole in parts.
struct InParts {
  std::vector<std::byte> data;
  int parts = 0;
  double most_bytes = 0;
};

InParts in_parts(const Volume& source,
                 const Transform& transform,
                 const ResampleOptions& options,
                 const PartLimits& limits,
                 const std::vector<double>& range = {}) {
  const Grid output = options.output_grid.value_or(source.grid);
  const std::size_t size = static_cast<std::size_t>(source.components) * size_of(source.type);
  InParts all;
  all.data.resize(size * static_cast<std::size_t>(output.voxel_count()));
  ResampleBlocks blocks(source.grid, output, transform, readers_of(transform), options.filter,
                        limits);
  while (std::optional<ResamplePart> part = blocks.next()) {
    part->source.ranges = {range};
    const std::vector<std::byte> window =
        cut(source.data.data(), source.grid, part->source.region, size);
    std::vector<std::byte> result(size * static_cast<std::size_t>(part->output.voxel_count()));
    const VolumeView view(source.grid, source.type, source.components, window.data(), Memory::host);
    void* const to = result.data();
    resample_part(std::span(&view, 1), transform, options, *part, std::span(&to, 1));
    const std::int64_t rows = part->output.end[1] - part->output.begin[1];
    const std::size_t bytes = size * static_cast<std::size_t>(output.dims[0] * rows);
    for (std::int64_t k = part->output.begin[2]; k < part->output.end[2]; ++k) {
      const std::int64_t voxel = output.dims[0] * (part->output.begin[1] + output.dims[1] * k);
      std::memcpy(all.data.data() + size * static_cast<std::size_t>(voxel),
                  result.data() + bytes * static_cast<std::size_t>(k - part->output.begin[2]),
                  bytes);
    }
    ++all.parts;
    all.most_bytes = std::max(all.most_bytes, blocks.bytes());
  }
  return all;
}

AffineTransform turned_about_z() {
  const double c = std::cos(0.4), s = std::sin(0.4);
  return {{c, -s, 0.1, s, c, 0, 0, 0.05, 1.1}, {3.2, -1.7, 0.6}};
}

/// Fields on the output's grid and on others, splines and affine maps, alone and in chains.
std::vector<Transform> transforms_on(const Grid& grid) {
  const Grid coarse = coarser(grid, 2.7);
  const DisplacementField same{grid, vectors_on<float>(grid, 3, 1)};
  const DisplacementField other{coarse, vectors_on<float>(coarse, 4, 2)};
  const BSplineTransform spline{coarse, vectors_on<double>(coarse, 3, 3)};
  DisplacementField bad = same;
  for (std::size_t n = 0; n < bad.displacement.size(); n += 997) {
    bad.displacement[n] = n % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : 1e30f;
  }
  return {turned_about_z(),
          same,
          other,
          spline,
          bad,
          TransformChain{{turned_about_z(), other, same}},
          TransformChain{{spline, turned_about_z(), other}}};
}

TEST(ResampleBlocks, HaveTheBitsOfTheWhole) {
  const Grid grid = scenes::oblique_grid(29, 18, 14);
  const std::vector<Transform> transforms = transforms_on(grid);
  Grid finer = grid;
  finer.dims = {35, 22, 17};
  for (double& spacing : finer.spacing) spacing *= 0.9;
  std::size_t cases = 0;
  for (const PixelType type :
       {PixelType::uint8, PixelType::int16, PixelType::float32, PixelType::float64}) {
    for (const int components : {1, 3}) {
      const Volume source = scenes::wavy_volume(grid, type, components);
      for (const Filter filter :
           {Filter::nearest, Filter::linear, Filter::cubic, Filter::lanczos}) {
        for (std::size_t t = 0; t < transforms.size(); ++t) {
          const bool is_odd = (t + cases) % 2 == 1;
          ResampleOptions options{.filter = filter, .background = 5, .only_in_field = is_odd};
          if (is_odd) options.output_grid = finer;
          const std::vector<std::byte> whole = resample(source, transforms[t], options).data;
          const double voxel = components * static_cast<double>(size_of(type));
          PartLimits limits{1e9, voxel, voxel, {1, 1}};
          const InParts one = in_parts(source, transforms[t], options, limits);
          EXPECT_EQ(one.parts, 1);
          EXPECT_TRUE(one.data == whole) << name_of(type) << components << name_of(filter) << t;
          limits.bytes = 0.8 * one.most_bytes;
          const InParts some = in_parts(source, transforms[t], options, limits);
          EXPECT_GT(some.parts, 1);
          EXPECT_LE(some.most_bytes, limits.bytes);
          EXPECT_TRUE(some.data == whole) << name_of(type) << components << name_of(filter) << t;
          ++cases;
        }
      }
    }
  }
  EXPECT_EQ(cases, 4 * 2 * 4 * 7);
}

/// The smallest parts: one row, and steps that do not divide the output.
TEST(ResampleBlocks, OfAnySizeHaveTheSameBits) {
  const Grid grid = scenes::oblique_grid(19, 13, 11);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  for (const Transform& transform : transforms_on(grid)) {
    const std::vector<std::byte> whole = resample(source, transform).data;
    for (const std::array<std::int64_t, 2>& step :
         {std::array<std::int64_t, 2>{1, 1}, {4, 3}, {8, 8}, {13, 2}}) {
      for (const double limit : {1e4, 2.5e4, 4e4, 6e4, 1e5}) {
        try {
          EXPECT_TRUE(in_parts(source, transform, {}, {limit, 4, 4, step}).data == whole) << limit;
        } catch (const std::invalid_argument&) {
          EXPECT_LT(limit, 1e5);  // all displacements, samples and results take less
        }
      }
    }
  }
}

TEST(ResampleBlocks, ClampToTheRangeOfTheWhole) {
  const Grid grid = scenes::unit_grid(24, 20, 30);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  const DisplacementField field{grid, vectors_on<float>(grid, 2, 7)};
  const ResampleOptions options{.filter = Filter::cubic, .overshoot = Overshoot::clamp};
  const auto samples = source.samples<float>();
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
  const std::vector<double> range{static_cast<double>(*low), static_cast<double>(*high)};

  const InParts result = in_parts(source, field, options, {8e4, 4, 4, {1, 1}}, range);

  EXPECT_GT(result.parts, 3);
  EXPECT_TRUE(result.data == resample(source, field, options).data);
}

TEST(ResampleBlocks, ThatDoNotFitAreRefused) {
  const Grid grid = scenes::unit_grid(24, 20, 30);
  const DisplacementField field{grid, vectors_on<float>(grid, 2, 7)};
  ResampleBlocks blocks(grid, grid, field, readers_of(field), Filter::linear, {1000, 4, 4, {1, 1}});
  EXPECT_EQ(message_of<std::invalid_argument>([&] { blocks.next(); }),
            "a part of the output exceeds the limit of memory");
  EXPECT_GT(blocks.bytes(), 1000);
  EXPECT_LT(blocks.bytes(), 24 * 12 * 12);
  EXPECT_EQ(message_of<std::invalid_argument>([&] {
              ResampleBlocks(grid, grid, field, {}, Filter::linear, {1e9, 4, 4, {1, 1}});
            }),
            "fields: expected a reader of every link");
}

TEST(ResampleBlocks, NeedWholeRowsAndWindowsWithinTheirGrids) {
  const Grid grid = scenes::unit_grid(9, 8, 7);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  const VolumeView view(source);
  Volume result = make_volume(grid, PixelType::float32);
  void* const to = result.data.data();
  const Region all{{0, 0, 0}, grid.dims};
  const auto message = [&](const ResamplePart& part, const ResampleOptions& options) {
    return message_of<std::invalid_argument>([&] {
      resample_part(std::span(&view, 1), AffineTransform{}, options, part, std::span(&to, 1));
    });
  };
  EXPECT_EQ(message({{{1, 0, 0}, {9, 8, 7}}, {all}}, {}),
            "region: expected whole rows of the output");
  EXPECT_NE(message({all, {{{0, 0, 0}, {9, 8, 8}}}}, {}), "");
  EXPECT_EQ(message({all, {{{0, 0, 0}, {9, 8, 6}}}}, {.filter = Filter::bspline}),
            "source window: bspline and gaussian need the whole source");
  EXPECT_EQ(message({all, {{{0, 0, 0}, {9, 8, 6}}}},
                    {.filter = Filter::cubic, .overshoot = Overshoot::clamp}),
            "source window: expected the range of every source");
}
}  // namespace
}  // namespace tetwarp::test
