/// @file test_cell_work.cpp
/// Which cells are kept, sampled or filled; a filled cell has one value wherever it is sampled.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kernels/warp/cell_work.hpp"
#include "tests/support/stages.hpp"

namespace tetwarp::test {
namespace {
template <class Exec>
class CellWork : public EachExec<Exec> {
 protected:
  /// The work of every cell of a mesh over a float32 source.
  struct Found {
    std::vector<std::int64_t> work;
    std::int64_t constant_count = 0;
  };
  Found run(const StageInput& input,
            const Volume& volume,
            const std::vector<std::uint8_t>& touched = {},
            bool knows_source = true) {
    const Stages<Exec> stages(this->arrays(), input);
    const auto samples = volume.samples<float>();
    const Region whole{{0, 0, 0}, volume.grid.dims};
    RasterJob<float> job = {};
    job.setups = stages.setups;
    job.pairs = stages.pairs;
    job.ranges = stages.ranges;
    job.frame = input.frame;
    job.source = source_view<float>(whole, 1,
                                    this->upload(std::vector(samples.begin(), samples.end())).data);
    UniformMap map = make_uniform_map(job.source);
    const auto reach = this->template zeros<std::uint8_t>(map.block_count());
    volume_uniform(this->exec(), job.source, View<const std::int32_t>(stages.tets),
                   View<const Node>(this->upload(input.rest)), reach,
                   this->template zeros<std::uint8_t>(reach.size),
                   this->template zeros<std::int64_t>(1));
    if (knows_source) map.reach = reach;
    const auto work = this->template zeros<std::int64_t>(input.frame.cell_count());
    const auto count = this->template zeros<std::int64_t>(1);
    cell_work(this->exec(), CellWorkOp<float>{job, map, this->upload(touched), work, count});
    return {this->download(work), this->download(count).front()};
  }
};
TYPED_TEST_SUITE(CellWork, Execs, ExecNames);

using Work = std::vector<std::int64_t>;

/// A tetrahedron that holds the whole frame of 40x16x16 voxels, moved by `shift` along i.
StageInput wide_tet(double shift) {
  const auto nodes = [](double x) {
    return std::vector<Node>{node_at(x - 1, -1, -1), node_at(x + 99, -1, -1),
                             node_at(x - 1, 99, -1), node_at(x - 1, -1, 99)};
  };
  return one_tet(nodes(shift), nodes(0), frame_of(40, 16, 16));
}

Volume uniform_volume(std::int64_t nx, float value) {
  Volume volume = make_volume(scenes::unit_grid(nx, 16, 16), PixelType::float32);
  std::ranges::fill(volume.samples<float>(), value);
  return volume;
}

/// Voxels 0 to 39 along i; a voxel at x reads samples x - shift and the next one.
TYPED_TEST(CellWork, FillsCellsThatSampleOneValue) {
  Volume volume = uniform_volume(40, 2.5f);
  volume.samples<float>()[39] = 7;  // at (39, 0, 0), in the last block

  const auto found = this->run(wide_tet(0.25), volume);

  ASSERT_EQ(found.work.size(), 20u);
  for (std::size_t cell = 0; cell < 20; ++cell) {
    EXPECT_EQ(found.work[cell] >= 0, cell % 5 < 4) << cell;
    if (found.work[cell] >= 0) {
      EXPECT_EQ(volume.samples<float>()[static_cast<std::size_t>(found.work[cell])], 2.5f);
    } else {
      EXPECT_EQ(found.work[cell], sample_cell);
    }
  }
  EXPECT_EQ(found.constant_count, 16);
}

/// Positions 24.5 to 31.5 lie in one block, the last of them blends the first sample of the next.
TYPED_TEST(CellWork, LooksAtTheUpperNeighborOfTheLastPosition) {
  Volume volume = uniform_volume(40, 2.5f);
  volume.samples<float>()[32] = 7;

  const auto found = this->run(wide_tet(-0.5), volume);

  EXPECT_GE(found.work[2], 0);
  EXPECT_EQ(found.work[3], sample_cell);
}

/// Half a voxel beyond the outermost centers there is the background, another value.
TYPED_TEST(CellWork, SamplesCellsThatReachTheEndOfTheSource) {
  EXPECT_EQ(this->run(wide_tet(0.45), uniform_volume(40, 1)).constant_count, 20);
  EXPECT_EQ(this->run(wide_tet(0.55), uniform_volume(40, 1)).constant_count, 16);
  EXPECT_EQ(this->run(wide_tet(-0.45), uniform_volume(40, 1)).constant_count, 20);
  EXPECT_EQ(this->run(wide_tet(-0.55), uniform_volume(40, 1)).constant_count, 16);
}

TYPED_TEST(CellWork, KeepsCellsThatNoMovedTetrahedronTouches) {
  std::vector<std::uint8_t> touched(20, 0);
  touched[3] = touched[7] = 1;

  const auto filled = this->run(wide_tet(0.25), uniform_volume(40, 2.5f), touched);
  const auto sampled = this->run(wide_tet(0.25), uniform_volume(40, 2.5f), touched, false);

  for (std::size_t cell = 0; cell < 20; ++cell) {
    EXPECT_EQ(filled.work[cell] >= 0, touched[cell] == 1);
    EXPECT_EQ(filled.work[cell] == keep_cell, touched[cell] == 0);
    EXPECT_EQ(sampled.work[cell], touched[cell] == 1 ? sample_cell : keep_cell);
  }
  EXPECT_EQ(filled.constant_count, 2);
}

TYPED_TEST(CellWork, SamplesCellsWithoutATetrahedron) {
  const std::vector<Node> nodes = {node_at(0, 0, 0), node_at(7, 0, 0), node_at(0, 7, 0),
                                   node_at(0, 0, 7)};

  const auto found = this->run(one_tet(nodes, nodes, frame_of(24, 8, 8)), uniform_volume(24, 1));

  EXPECT_GE(found.work[0], 0);
  EXPECT_EQ(found.work[1], sample_cell);
  EXPECT_EQ(found.work[2], sample_cell);
}

/// On every scene: the taps of every voxel of a filled cell, under every map of the cell, read the
/// cell's value only.
TYPED_TEST(CellWork, IsRightAboutEveryTap) {
  std::int64_t filled = 0;
  for (const scenes::Scene& scene : scenes::adversarial_scenes(48)) {
    Volume volume = scenes::wavy_volume(scene.source_grid, PixelType::float32);
    const auto& n = scene.source_grid.dims;
    std::size_t v = 0;
    for (std::int64_t k = 0; k < n[2]; ++k) {
      for (std::int64_t j = 0; j < n[1]; ++j) {
        for (std::int64_t i = 0; i < n[0]; ++i, ++v) {
          if (k > 12 || j > 30) volume.samples<float>()[v] = j > 30 ? 3.0f : 4.0f;
        }
      }
    }
    const StageInput input = input_of(scene);
    const auto found = this->run(input, volume);
    const Stages<TypeParam> stages(this->arrays(), input);
    const auto setups = this->download(stages.setups);
    const auto pairs = this->download(stages.pairs);
    const auto ranges = this->download(stages.ranges);
    const auto source =
        source_view<float>(Region{{0, 0, 0}, volume.grid.dims}, 1, volume.data.data());
    for (std::size_t cell = 0; cell < found.work.size(); ++cell) {
      if (found.work[cell] < 0) continue;
      ++filled;
      const float value = volume.samples<float>()[static_cast<std::size_t>(found.work[cell])];
      const auto nx = static_cast<std::size_t>(input.frame.cells[0]),
                 ny = static_cast<std::size_t>(input.frame.cells[1]);
      const int corner[3] = {static_cast<int>(8 * (cell % nx)),
                             static_cast<int>(8 * (cell / nx % ny)),
                             static_cast<int>(8 * (cell / nx / ny))};
      for (std::uint32_t p = ranges[cell].begin; p < ranges[cell].end; ++p) {
        const TetSetup& tet = setups[static_cast<std::size_t>(tet_of(pairs[p]))];
        double start[3], linear[3][3];
        map_start(tet, corner, start, linear);
        const auto map = make_source_map<double>(start, linear);
        for (int voxel = 0; voxel < 512; ++voxel) {
          const int x[3] = {voxel % 8, voxel / 8 % 8, voxel / 64};
          bool in_box = true;
          for (int axis = 0; axis < 3; ++axis) {
            in_box = in_box && corner[axis] + x[axis] >= tet.begin[axis] &&
                     corner[axis] + x[axis] < tet.end[axis];
          }
          if (!in_box) continue;
          double position[3];
          local_position(map, x[0], x[1], x[2], position);
          const auto tap = tap_of(source, Filter::linear, map.whole, position);
          ASSERT_TRUE(tap.inside) << scene.name;
          for (int corner_of_tap = 0; corner_of_tap < 8; ++corner_of_tap) {
            const std::int64_t at = tap.offset[0][corner_of_tap & 1] +
                                    tap.offset[1][corner_of_tap >> 1 & 1] +
                                    tap.offset[2][corner_of_tap >> 2];
            ASSERT_EQ(source.data[at], value) << scene.name << " cell " << cell;
          }
        }
      }
    }
  }
  EXPECT_GT(filled, 100);
}
}  // namespace
}  // namespace tetwarp::test
