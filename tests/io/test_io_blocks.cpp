/// @file test_io_blocks.cpp
/// Volume files read and written region by region.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
/// A region of a volume's samples, copied voxel by voxel.
std::vector<std::byte> cut_out(const Volume& volume, const Region& region) {
  const std::size_t voxel = static_cast<std::size_t>(volume.components) * size_of(volume.type);
  const auto& n = volume.grid.dims;
  std::vector<std::byte> part;
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
      for (std::int64_t i = region.begin[0]; i < region.end[0]; ++i) {
        const std::byte* from =
            volume.data.data() + static_cast<std::size_t>((k * n[1] + j) * n[0] + i) * voxel;
        part.insert(part.end(), from, from + voxel);
      }
    }
  }
  return part;
}

/// Samples that differ, and a corner that holds zeros alone.
Volume patterned(PixelType type, int components, const std::string& name, std::size_t seed) {
  Grid grid;
  grid.dims = {150, 75, 70};
  Volume volume = make_volume(grid, type, components, name);
  for (std::size_t b = 0; b < volume.data.size() / 2; ++b) {
    volume.data[b] = static_cast<std::byte>((b * 37 + b / 251 + seed) % 120);
  }
  return volume;
}

/// Regions that end where bricks do, the last first.
std::vector<Region> bricks_of(const Grid& grid, const std::array<std::int64_t, 3>& step) {
  std::vector<Region> regions;
  for (std::int64_t k = 0; k < grid.dims[2]; k += 2 * step[2]) {
    for (std::int64_t j = 0; j < grid.dims[1]; j += step[1]) {
      Region region{{0, j, k}, grid.dims};
      region.end[1] = std::min(j + step[1], grid.dims[1]);
      region.end[2] = std::min(k + 2 * step[2], grid.dims[2]);
      regions.push_back(region);
    }
  }
  std::ranges::reverse(regions);
  return regions;
}

std::vector<ArrayHeader> headers_of(const std::vector<Volume>& volumes) {
  std::vector<ArrayHeader> headers;
  headers.reserve(volumes.size());
  for (const Volume& v : volumes) headers.push_back({v.name, v.type, v.components});
  return headers;
}

void write_step(BlockVolumeWriter& writer, const std::vector<Volume>& volumes) {
  const Grid& grid = volumes.front().grid;
  for (const Region& region : bricks_of(grid, block_step(grid, headers_of(volumes)))) {
    for (std::size_t a = 0; a < volumes.size(); ++a) {
      writer.write(a, region, cut_out(volumes[a], region).data());
    }
  }
}

TEST(IoBlocks, StaticFilesHoldWhatTheirRegionsHeld) {
  const ScratchFolder folder;
  const std::vector<Volume> volumes{patterned(PixelType::float32, 1, "density", 0),
                                    patterned(PixelType::int16, 3, "flow", 5)};
  for (const int compress : {0, 1}) {
    BlockVolumeWriter writer(folder / "a.vtkhdf", volumes[0].grid, headers_of(volumes),
                             {.compress = compress}, false);
    write_step(writer, volumes);

    const WrittenFile written = writer.finish();

    EXPECT_GT(written.chunks_background, 0);
    EXPECT_LT(written.chunks_background, written.chunks);
    EXPECT_EQ(folder.entry_count(), 1);
    for (const Volume& volume : volumes) {
      const Volume read = read_volume(folder / "a.vtkhdf", volume.name);
      EXPECT_EQ(read.data, volume.data);
      EXPECT_EQ(read.grid, volume.grid);
      const VolumeReader reader(folder / "a.vtkhdf", volume.name);
      for (const Region& region :
           {Region{{3, 5, 7}, {149, 75, 9}}, Region{{149, 0, 0}, {150, 1, 70}}}) {
        std::vector<std::byte> part = cut_out(volume, region);
        const std::vector<std::byte> expected = part;
        std::ranges::fill(part, std::byte{0xee});
        reader.read(region, part.data());
        EXPECT_EQ(part, expected);
      }
      EXPECT_GT(reader.chunk_bytes(), 0);
    }
  }
}

TEST(IoBlocks, TemporalFilesHoldTheirStepsAndRepeatThem) {
  const ScratchFolder folder;
  const std::vector<Volume> first{patterned(PixelType::uint8, 2, "density", 0)};
  const std::vector<Volume> second{patterned(PixelType::uint8, 2, "density", 50)};
  BlockVolumeWriter writer(folder / "a.vtkhdf", first[0].grid, headers_of(first), {}, true);
  EXPECT_NE(io_error([&] { writer.repeat_step(0); }), "");
  writer.begin_step(0.5);
  write_step(writer, first);
  writer.repeat_step(1);
  writer.begin_step(2);
  write_step(writer, second);
  writer.finish();

  EXPECT_EQ(read_volume_header(folder / "a.vtkhdf").times, (std::vector<double>{0.5, 1, 2}));
  EXPECT_EQ(read_volume(folder / "a.vtkhdf", {}, 0).data, first[0].data);
  EXPECT_EQ(read_volume(folder / "a.vtkhdf", {}, 1).data, first[0].data);
  EXPECT_EQ(read_volume(folder / "a.vtkhdf", {}, 2).data, second[0].data);
}

/// No reader takes a time that is not finite.
TEST(IoBlocks, TimesMustBeFinite) {
  const ScratchFolder folder;
  const std::vector<Volume> volumes{patterned(PixelType::uint8, 2, "density", 0)};
  const Mesh mesh = two_tets();
  for (const double time : {double{NAN}, double{INFINITY}, double{-INFINITY}}) {
    const auto is_refused = [&](const auto& write) {
      return io_error(write).find("the time of a step is") != std::string::npos;
    };
    for (const char* const name : {"a.vtkhdf", "a.nii", "a.nrrd"}) {
      BlockVolumeWriter writer(folder / name, volumes[0].grid, headers_of(volumes), {}, true);
      EXPECT_TRUE(is_refused([&] { writer.begin_step(time); })) << name;
      writer.begin_step(0);
      EXPECT_TRUE(is_refused([&] { writer.repeat_step(time); })) << name;
    }
    TemporalVolumeWriter whole(folder / "b.vtkhdf");
    EXPECT_TRUE(is_refused([&] { whole.append(time, {&volumes[0]}); }));
    const std::vector<std::vector<Point3>> steps{mesh.rest_positions};
    EXPECT_TRUE(is_refused([&] { write_mesh(folder / "c.vtkhdf", mesh, steps, {time}); }));
  }
}

/// Axes of one sample are not in the file, as VTK 9.3 and later expect; static and temporal, of one
/// and three components, blocks or whole.
TEST(IoBlocks, HoldImagesOfOneSliceRowAndVoxel) {
  const ScratchFolder folder;
  for (const std::array<std::int64_t, 3> dims : {std::array<std::int64_t, 3>{5, 4, 1},
                                                 {5, 1, 3},
                                                 {1, 4, 3},
                                                 {5, 1, 1},
                                                 {1, 1, 3},
                                                 {1, 1, 1}}) {
    Grid grid = oblique_grid();
    grid.dims = dims;
    for (const int components : {1, 3}) {
      Volume volume = make_volume(grid, PixelType::int16, components, "density");
      for (std::size_t b = 0; b < volume.data.size(); ++b)
        volume.data[b] = static_cast<std::byte>(b);
      for (const bool is_temporal : {false, true}) {
        for (const ChunkShape chunks : {ChunkShape::rows, ChunkShape::bricks}) {
          BlockVolumeWriter writer(folder / "a.vtkhdf", grid, headers_of({volume}), {.compress = 1},
                                   is_temporal, chunks);
          if (is_temporal) writer.begin_step(0);
          writer.write(0, {{0, 0, 0}, dims}, volume.data.data());
          writer.finish();

          const Volume read = read_volume(folder / "a.vtkhdf");
          EXPECT_EQ(read.grid.dims, dims);
          EXPECT_EQ(read.components, components);
          EXPECT_EQ(read.data, volume.data);
          Volume last = make_volume(grid, PixelType::int16, components);
          const Region voxel{{dims[0] - 1, dims[1] - 1, dims[2] - 1}, dims};
          VolumeReader(folder / "a.vtkhdf").read(voxel, last.data.data());
          const std::size_t bytes = 2 * static_cast<std::size_t>(components);
          EXPECT_TRUE(std::equal(last.data.begin(), last.data.begin() + std::ptrdiff_t(bytes),
                                 volume.data.end() - std::ptrdiff_t(bytes)));
        }
      }
    }
  }
}

TEST(IoBlocks, LeaveNothingUnlessFinished) {
  const ScratchFolder folder;
  const Volume volume = patterned(PixelType::uint8, 1, "density", 0);
  {
    BlockVolumeWriter writer(folder / "a.vtkhdf", volume.grid, headers_of({volume}), {}, false);
    write_step(writer, {volume});
  }
  EXPECT_NE(io_error([&] { BlockVolumeWriter(folder / "a.vtkhdf", volume.grid, {}, {}, false); }),
            "");
  EXPECT_EQ(folder.entry_count(), 0);
}
}  // namespace
}  // namespace tetwarp::test
