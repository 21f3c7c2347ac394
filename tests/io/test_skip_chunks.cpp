/// @file test_skip_chunks.cpp
/// Chunks of background are counted, and stored only if the options require it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include <tetwarp/io.hpp>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
/// 64x64x80 float32 samples, 16 slices in a chunk, five chunks, one of them not all background.
Volume mostly_background() {
  Grid grid;
  grid.dims = {64, 64, 80};
  Volume volume = make_volume(grid, PixelType::float32);
  std::ranges::fill(volume.samples<float>(), -1024.0F);
  volume.samples<float>()[std::size_t{64} * 64 * 40] = 7;
  return volume;
}

TEST(SkipChunks, CountsChunksAndThoseOfBackground) {
  const ScratchFolder folder;
  const Volume volume = mostly_background();
  for (const bool skips : {true, false}) {
    const WrittenFile file =
        write_volumes(folder / "v.vtkhdf", {&volume},
                      {.background = -1024, .skip_background_chunks = skips, .fingerprint = {}});

    EXPECT_EQ(file.chunks, 5);
    EXPECT_EQ(file.chunks_background, skips ? 4 : 0);
    EXPECT_EQ(file.bytes / (256 << 10), skips ? 1 : 5);  // of samples; the rest is less
    EXPECT_EQ(read_volume(folder / "v.vtkhdf").data, volume.data);
  }
}

TEST(SkipChunks, CountsOverArraysAndSteps) {
  const ScratchFolder folder;
  const Volume volume = mostly_background();
  Volume other = volume;
  other.name = "other";
  TemporalVolumeWriter writer(folder / "t.vtkhdf", {.background = -1024, .fingerprint = {}});
  writer.append(0, {&volume, &other});
  writer.append(1, {&volume, &other});
  writer.repeat(2);

  const WrittenFile file = writer.finish();

  EXPECT_EQ(file.chunks, 20);
  EXPECT_EQ(file.chunks_background, 16);
}
}  // namespace
}  // namespace tetwarp::test
