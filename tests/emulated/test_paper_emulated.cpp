/// @file test_paper_emulated.cpp
/// The method of the paper that the benchmarks time: its kernels, emulated, draw what its threads
/// draw.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/peers/paper_device.cuh"
#include "bench/peers/peer.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::bench {
namespace {
/// Ten tetrahedra of several cells each, samples above zero, and an output.
struct Input {
  scenes::Scene scene;
  std::vector<float> source;
  std::vector<float> output;

  explicit Input(const std::string& motion) {
    scene.source_grid = scene.output_grid = scenes::unit_grid(30, 28, 41);
    scene.mesh = scenes::lattice({1, 1, 2}, {2, 3, 2}, {26, 25, 38});
    const std::vector<Point3>& rest = scene.mesh.rest_positions;
    scene.deformed = motion == "rotated"   ? scenes::rotated_45_45(rest, {15, 14, 20})
                     : motion == "shifted" ? scenes::shifted(rest, {2, -1, 5})
                                           : scenes::waved(rest, 3.0, 7);
    const auto [nx, ny, nz] = scene.source_grid.dims;
    for (std::int64_t k = 0; k < nz; ++k) {
      for (std::int64_t j = 0; j < ny; ++j) {
        for (std::int64_t i = 0; i < nx; ++i) {
          source.push_back(1.0f + 0.01f * static_cast<float>(i + 2 * j + 3 * k));
        }
      }
    }
    output.resize(static_cast<std::size_t>(scene.output_grid.voxel_count()));
  }
  PeerInput peer() { return {scene, source.data(), output.data(), 1, nullptr}; }
};

std::vector<float> drawn_by_threads(Input& input, bool with_cells, PaperCounts& counts) {
  paper_method(input.peer(), with_cells, &counts)();
  return input.output;
}

class PaperEmulated : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Motions, PaperEmulated, ::testing::Values("rotated", "shifted", "waved"));

TEST_P(PaperEmulated, DrawsTheVoxelsThatThreadsDraw) {
  Input input(GetParam());
  for (const bool with_cells : {true, false}) {
    PaperCounts counts;
    const std::vector<float> threads = drawn_by_threads(input, with_cells, counts);
    PaperOnDevice device(input.peer(), with_cells);
    for (int step = 0; step < 2; ++step) {  // the second one finds its memory as the first left it
      device.step();
      std::vector<float> found(threads.size(), -1.0f);
      device.get(found.data());

      double difference = 0;
      std::int64_t covered = 0;
      for (std::size_t v = 0; v < found.size(); ++v) {
        ASSERT_EQ(found[v] == 0, threads[v] == 0) << "voxel " << v;
        covered += threads[v] != 0;
        difference = std::max<double>(difference, std::abs(found[v] - threads[v]));
      }
      EXPECT_GT(covered, 100);
      // A voxel on a face has the map of either of its tetrahedra.
      EXPECT_LT(difference, 1e-4);
      EXPECT_EQ(device.drawn(), with_cells ? counts.drawn : counts.cells);
    }
  }
}

TEST_P(PaperEmulated, CellsChangeNoVoxelThatTheMethodCovers) {
  Input input(GetParam());
  PaperCounts with, without;
  const std::vector<float> cells = drawn_by_threads(input, true, with);
  const std::vector<float> boxes = drawn_by_threads(input, false, without);

  for (std::size_t v = 0; v < cells.size(); ++v) {
    ASSERT_EQ(cells[v] == 0, boxes[v] == 0) << "voxel " << v;
  }
  EXPECT_EQ(with.passed, without.passed);
  EXPECT_LT(with.tested, without.tested);
  EXPECT_LT(with.drawn, with.cells);
  EXPECT_EQ(without.drawn, static_cast<std::int64_t>(input.scene.mesh.tets.size()));
}
}  // namespace
}  // namespace tetwarp::bench
