/// @file test_output_edges.cpp
/// No byte beside the output is written, at any alignment of the output.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/make.hpp>
#include <tetwarp/warp.hpp>

#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
constexpr std::byte untouched{0xa5};
constexpr std::size_t margin = 256;  // bytes, and whole cache lines

/// What step() writes from byte `start` of a cache line on; fails where it writes more.
std::vector<std::byte> written_at(std::size_t start,
                                  Warper& warper,
                                  const std::vector<Point3>& deformed,
                                  std::size_t size) {
  std::vector<std::byte> memory(64 + margin + start + size + margin, untouched);
  const std::size_t line = -reinterpret_cast<std::uintptr_t>(memory.data()) % 64;
  const auto begin = memory.begin() + static_cast<std::ptrdiff_t>(line + margin + start);
  const auto end = begin + static_cast<std::ptrdiff_t>(size);
  void* const data = &*begin;

  warper.step(deformed, {.volumes = std::span<void* const>(&data, 1)});

  const auto is_untouched = [](std::byte byte) { return byte == untouched; };
  EXPECT_TRUE(std::all_of(memory.begin(), begin, is_untouched)) << "in front, from " << start;
  EXPECT_TRUE(std::all_of(end, memory.end(), is_untouched)) << "behind, from " << start;
  return {begin, end};
}

/// Rows narrower and wider than cache lines, outputs that begin anywhere in one, two threads whose
/// rows share lines: all voxels arrive, and nothing else changes.
TEST(OutputEdges, AreKeptWhereverTheOutputBegins) {
  for (const std::array<std::int64_t, 3>& dims :
       {std::array<std::int64_t, 3>{3, 18, 9}, {37, 17, 10}, {530, 9, 9}}) {
    for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::float32}) {
      for (const int components : {1, 3}) {
        Grid grid;
        grid.dims = dims;
        const Volume volume = scenes::wavy_volume(grid, type, components);
        const Mesh mesh = make_lattice_mesh(volume);
        std::vector<Point3> deformed = mesh.rest_positions;
        for (Point3& p : deformed) p[0] = 0.7 * p[0] + 1.3;  // uncovered voxels on both sides
        WarpOptions options;
        options.backend = Backend::cpu;
        options.threads = 2;
        options.expert.skip.unchanged_tets = false;  // the memory is another each time
        Warper warper(volume, mesh, options);
        const Volume expected = warper.step(deformed);
        for (std::size_t start = 0; start < 64; start += 5) {
          const auto written = written_at(start, warper, deformed, expected.data.size());
          EXPECT_TRUE(written == expected.data) << "from " << start;
        }
      }
    }
  }
}

/// A region that begins and ends inside cells is a window on the whole output.
TEST(OutputEdges, AreThoseOfTheRegion) {
  Grid grid;
  grid.dims = {61, 19, 18};
  const Volume volume = scenes::wavy_volume(grid, PixelType::float32, 1);
  const Mesh mesh = make_lattice_mesh(volume);
  std::vector<Point3> deformed = mesh.rest_positions;
  for (Point3& p : deformed) p[0] += 0.3 * p[1];
  WarpOptions options;
  options.backend = Backend::cpu;
  options.threads = 2;
  const Volume whole = warp(volume, mesh, deformed, options).volume;
  const auto all = whole.samples<float>();
  for (const int first : {1, 7, 13}) {
    options.region = Region{.begin = {first, 2, 3}, .end = {61 - first, 17, 15}};
    Warper warper(volume, mesh, options);

    const std::vector<std::byte> bytes = written_at(
        4, warper, deformed, static_cast<std::size_t>(4 * warper.output_grid().voxel_count()));

    const auto* samples = reinterpret_cast<const float*>(bytes.data());
    const Grid part = warper.output_grid();
    for (std::int64_t k = 0; k < part.dims[2]; ++k) {
      for (std::int64_t j = 0; j < part.dims[1]; ++j) {
        const auto row =
            all.subspan(static_cast<std::size_t>((61 * (19 * (k + 3) + j + 2)) + first),
                        static_cast<std::size_t>(part.dims[0]));
        const auto* own = samples + part.dims[0] * (part.dims[1] * k + j);
        EXPECT_TRUE(std::equal(row.begin(), row.end(), own)) << "row " << j << ", " << k;
      }
    }
  }
}
}  // namespace
}  // namespace tetwarp::test
