/// @file test_blocks.cpp
/// Warps in blocks: windows hold all that is read, blocks have the bits of the whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/blocks.hpp>

#include "host/warp/hex_split.hpp"
#include "tests/support/curved_scenes.hpp"
#include "tests/support/each_backend.hpp"
#include "tests/support/hex_scenes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
/// A copy of a region of a volume that ends with its last sample.
std::vector<std::byte> cut_out(const Volume& volume, const Region& region) {
  const std::size_t voxel = static_cast<std::size_t>(volume.components) * size_of(volume.type);
  const auto& n = volume.grid.dims;
  std::vector<std::byte> part(static_cast<std::size_t>(region.voxel_count()) * voxel);
  const std::size_t row = static_cast<std::size_t>(region.end[0] - region.begin[0]) * voxel;
  std::byte* to = part.data();
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j, to += row) {
      const auto first = static_cast<std::size_t>((k * n[1] + j) * n[0] + region.begin[0]);
      std::memcpy(to, volume.data.data() + first * voxel, row);
    }
  }
  return part;
}

/// The whole scene, computed block by block from windows alone.
struct InBlocks {
  Warped warped;
  BlockPlan plan;
  std::int64_t window_voxels = 0;
};

InBlocks run_blocks(const Volume& source,
                    const scenes::Scene& scene,
                    WarpOptions options,
                    const BlockLimits& limits,
                    const std::vector<double>& range = {},
                    const std::vector<MidNodes>& mid_nodes = {}) {
  options.output_grid = scene.output_grid;
  InBlocks all;
  BlockPlanner planner(scene.source_grid, scene.mesh, options, mid_nodes);
  all.plan = planner.plan(scene.deformed, limits);
  Warped& whole = all.warped;
  whole.volume = make_volume(scene.output_grid, source.type, source.components);
  const auto voxels = static_cast<std::size_t>(scene.output_grid.voxel_count());
  whole.mask.assign(voxels, 0xee);
  whole.owner.assign(voxels, -99);
  const std::size_t voxel = static_cast<std::size_t>(source.components) * size_of(source.type);
  const auto& n = scene.output_grid.dims;
  for (const WarpBlock& block : all.plan.blocks) {
    const std::vector<std::byte> window = cut_out(source, block.source);
    const VolumeView view(source.grid, source.type, source.components, window.data(), Memory::host);
    options.source_window = SourceWindow{block.source, {range}};
    all.window_voxels += block.source.voxel_count();
    options.region = block.output;
    const BlockMesh part = block_mesh(scene.mesh, block, mid_nodes);
    Warper warper(std::span(&view, 1), CurvedMesh{part.mesh, part.mid_nodes}, options);
    const Warped piece = run_step(warper, source, part.of(scene.deformed));
    whole.counts += piece.counts;
    const std::size_t row = static_cast<std::size_t>(block.output.end[0] - block.output.begin[0]);
    std::size_t from = 0;
    for (std::int64_t k = block.output.begin[2]; k < block.output.end[2]; ++k) {
      for (std::int64_t j = block.output.begin[1]; j < block.output.end[1]; ++j, from += row) {
        const auto to = static_cast<std::size_t>((k * n[1] + j) * n[0] + block.output.begin[0]);
        std::memcpy(whole.volume.data.data() + to * voxel, piece.volume.data.data() + from * voxel,
                    row * voxel);
        std::copy_n(piece.mask.data() + from, row, whole.mask.data() + to);
        for (std::size_t i = 0; i < row; ++i) {
          const std::int32_t t = piece.owner[from + i];
          whole.owner[to + i] = t < 0 ? t : block.cells.at(static_cast<std::size_t>(t));
        }
      }
    }
  }
  return all;
}

/// Small blocks of float32.
const BlockLimits small{.max_voxels = 16 * 16 * 16};

class Blocks : public EachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, Blocks, each_backend, name_of_backend);

TEST_P(Blocks, OfEverySceneHaveTheBitsOfTheWhole) {
  std::int64_t window_voxels = 0, source_voxels = 0;
  for (const scenes::Scene& scene : scenes::adversarial_scenes(20)) {
    SCOPED_TRACE(scene.name);
    const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
    WarpOptions options;
    options.backend = GetParam();
    const Warped whole = run_warp(source, scene, GetParam(), options);

    const InBlocks blocks = run_blocks(source, scene, options, small);

    EXPECT_TRUE(is_same(blocks.warped, whole));
    EXPECT_EQ(blocks.warped.counts.covered, whole.counts.covered);
    EXPECT_EQ(blocks.warped.counts.voxels, whole.counts.voxels);
    EXPECT_EQ(blocks.plan.inverted, whole.counts.inverted);
    EXPECT_EQ(blocks.plan.flat, whole.counts.flat);
    EXPECT_GT(blocks.plan.blocks.size(), 1u);
    window_voxels += blocks.window_voxels;
    source_voxels += scene.source_grid.voxel_count() * std::ssize(blocks.plan.blocks);
  }
  EXPECT_LT(window_voxels, source_voxels * 2 / 3) << "windows are no smaller than the source";
}

TEST_P(Blocks, OfHexahedraAndOfMeansHaveTheBitsOfTheWhole) {
  const Grid grid = scenes::unit_grid(40, 36, 32);
  for (const double shrink : {1.0, 0.4}) {
    const HexBox box = hex_box({4, 3, 3}, {-0.5, -0.5, -0.5}, {39.5, 35.5, 31.5}, bent(2.5));
    scenes::Scene scene = {"hexahedra", box.mesh, box.deformed, grid, grid};
    const auto middle = scene.mesh.hexes.begin() + 12;
    scene.mesh.tets = split_hexes(std::vector(scene.mesh.hexes.begin(), middle));
    scene.mesh.hexes.erase(scene.mesh.hexes.begin(), middle);
    for (Point3& p : scene.deformed) {
      for (double& x : p) x = shrink * x + 20 * (1 - shrink);
    }
    const Volume source = scenes::wavy_volume(grid, PixelType::float32);
    WarpOptions options{.antialias = shrink < 1, .outside = Outside::identity};
    options.backend = GetParam();

    const InBlocks blocks = run_blocks(source, scene, options, small);

    EXPECT_TRUE(is_same(blocks.warped, run_warp(source, scene, GetParam(), options))) << shrink;
    EXPECT_GT(blocks.plan.blocks.size(), 1u);
  }
}

/// Gently bent, so that windows are little larger than those of straight cells, and wildly, so that
/// cells fold; beside hexahedra and tetrahedra of four nodes.
TEST_P(Blocks, OfTenNodesHaveTheBitsOfTheWhole) {
  const Grid grid = scenes::unit_grid(40, 36, 32);
  CurvedMesh mesh = with_mid_nodes(scenes::lattice({5, 5, 4}, {1, 1, 1}, {38, 34, 22}));
  mesh.mid_nodes[7] = mesh.mid_nodes[40] = no_mid_nodes;
  const HexBox box = hex_box({2, 2, 1}, {1, 1, 22}, {38, 34, 31}, bent(1));
  const auto first = static_cast<std::int32_t>(mesh.mesh.rest_positions.size());
  for (auto hex : box.mesh.hexes) {
    for (std::int32_t& node : hex) node += first;
    mesh.mesh.hexes.push_back(hex);
  }
  std::vector<Point3>& rest = mesh.mesh.rest_positions;
  rest.insert(rest.end(), box.mesh.rest_positions.begin(), box.mesh.rest_positions.end());
  const Volume source = scenes::wavy_volume(grid, PixelType::int16);
  const std::int64_t corners = 6 * 6 * 5;
  for (const double bend : {0.3, 6.0}) {
    scenes::Scene scene = {"curved", mesh.mesh, shaken(rest, bend, 7), grid, grid};
    std::copy_n(rest.begin(), corners, scene.deformed.begin());
    std::copy(box.deformed.begin(), box.deformed.end(), scene.deformed.begin() + first);
    scene.mesh.rest_positions = shaken(rest, bend / 3, 8);
    WarpOptions options{.filter = Filter::cubic, .outside = Outside::identity};
    options.output_grid = grid;
    options.backend = GetParam();
    Warper warper(std::array{VolumeView(source)}, CurvedMesh{scene.mesh, mesh.mid_nodes}, options);
    const Warped whole = run_step(warper, source, scene.deformed);

    const InBlocks blocks = run_blocks(source, scene, options, small, {}, mesh.mid_nodes);
    const InBlocks straight = run_blocks(source, scene, options, small);

    EXPECT_TRUE(is_same(blocks.warped, whole)) << bend;
    EXPECT_FALSE(is_same(blocks.warped, straight.warped)) << bend;
    EXPECT_EQ(blocks.warped.counts.voxels_straightened, whole.counts.voxels_straightened);
    EXPECT_EQ(whole.counts.voxels_straightened > 0, bend > 1);
    EXPECT_GT(blocks.plan.blocks.size(), 8u);
    if (bend < 1) {
      EXPECT_LT(blocks.window_voxels, 1.5 * static_cast<double>(straight.window_voxels));
    }
    found("windows",
          static_cast<double>(blocks.window_voxels) / static_cast<double>(straight.window_voxels));
  }
}

TEST_P(Blocks, CulledByMasksHaveTheBitsOfTheWhole) {
  for (const char* name : {"rotated", "soup"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 40);
    const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::int16);
    WarpOptions options;
    options.backend = GetParam();
    const Warped whole = run_warp(source, scene, GetParam(), options);
    const BlockLimits large{.max_voxels = 32 * 32 * 32};
    options.expert.skip.grid_point_masks = true;

    const InBlocks blocks = run_blocks(source, scene, options, large);

    EXPECT_TRUE(is_same(blocks.warped, whole)) << name;
  }
}

TEST(BlockPlanner, CountsTheMasks) {
  const scenes::Scene scene = scenes::adversarial_scene("rotated", 40);
  WarpOptions options;
  const auto bytes = [&] {
    BlockPlanner planner(scene.source_grid, scene.mesh, options);
    return planner.plan(scene.deformed, {}).blocks.front().host_bytes;
  };
  const double without = bytes();

  options.expert.skip.grid_point_masks = true;

  EXPECT_GT(bytes(), without);
}

TEST_P(Blocks, OfEveryFilterAndPixelTypeHaveTheBitsOfTheWhole) {
  const std::pair<PixelType, int> types[] = {
      {PixelType::uint8, 1}, {PixelType::int16, 3}, {PixelType::float64, 1}, {PixelType::int64, 1}};
  for (const std::string name : {"rotated", "other_grid"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 20);
    for (const auto& [type, components] : types) {
      const Volume source = scenes::wavy_volume(scene.source_grid, type, components);
      for (const Filter filter :
           {Filter::nearest, Filter::linear, Filter::cubic, Filter::lanczos, Filter::labels}) {
        const bool is_label = filter == Filter::labels;
        if (is_label && (!is_integer(type) || components > 1)) continue;
        if (type == PixelType::int64 && !is_label && filter != Filter::nearest) continue;
        // The reference is slow, and one of its functions alone handles windows: one case is
        // enough.
        const bool is_checked = type == PixelType::uint8 && filter == Filter::cubic;
        if (GetParam() == Backend::reference && !is_checked) continue;
        SCOPED_TRACE(name + " " + name_of(type) + " filter " +
                     std::to_string(static_cast<int>(filter)));
        WarpOptions options;
        options.backend = GetParam();
        options.filter = filter;
        options.outside = Outside::identity;
        options.background = -3;

        EXPECT_TRUE(is_same(run_blocks(source, scene, options, small).warped,
                            run_warp(source, scene, GetParam(), options)));
      }
    }
  }
}

TEST_P(Blocks, ClampToTheRangeOfTheWholeSource) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 20);
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::uint8);
  const auto [low, high] = std::ranges::minmax(source.samples<std::uint8_t>());
  WarpOptions options;
  options.backend = GetParam();
  options.filter = Filter::lanczos;
  options.overshoot = Overshoot::clamp;

  EXPECT_THROW(run_blocks(source, scene, options, small), std::invalid_argument);
  EXPECT_TRUE(is_same(run_blocks(source, scene, options, small, {double(low), double(high)}).warped,
                      run_warp(source, scene, GetParam(), options)));
}

/// Of a column of 64 x 64 x 256 voxels that moves as a whole.
BlockPlan column_plan(const BlockLimits& limits) {
  const Grid grid = scenes::unit_grid(64, 64, 256);
  const Mesh mesh = covering_mesh(grid);
  return BlockPlanner(grid, mesh, {}).plan(moved(grid, mesh.rest_positions, {0.5, 0, 0}), limits);
}

TEST(BlockPlanner, KeepsToTheLimitsAndReadsLittleMoreThanItWrites) {
  const BlockLimits limits{.host = 2e6, .step = {64, 32, 32}};
  const BlockPlan plan = column_plan(limits);

  std::int64_t voxels = 0;
  for (const WarpBlock& block : plan.blocks) {
    EXPECT_LE(block.host_bytes, limits.host);
    EXPECT_GT(block.host_bytes, 2.0 * 4 * 2 * static_cast<double>(block.output.voxel_count()));
    EXPECT_LT(block.device_bytes, block.host_bytes);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(block.output.begin[axis] % limits.step[axis], 0);
      EXPECT_LE(block.source.end[axis] - block.source.begin[axis],
                block.output.end[axis] - block.output.begin[axis] + 6);
    }
    voxels += block.output.voxel_count();
  }
  EXPECT_EQ(voxels, 64 * 64 * 256);
  EXPECT_GT(plan.blocks.size(), 8u);
}

TEST(BlockPlanner, ReportsWhatTheSmallestBlockNeeds) {
  for (const BlockLimits& limits :
       {BlockLimits{.host = 1e5, .step = {64, 32, 32}}, BlockLimits{.host = -1},
        BlockLimits{.device = 1e5, .step = {64, 64, 64}}}) {
    const std::string message = message_of([&] { column_plan(limits); });

    EXPECT_NE(message.find("allow more"), std::string::npos) << message;
  }
}

TEST(BlockPlanner, RefusesNodesThatCannotBePlaced) {
  const Grid grid = scenes::unit_grid(16, 16, 16);
  const Mesh mesh = covering_mesh(grid);
  std::vector<Point3> far = mesh.rest_positions;
  far[5][1] = 1e300;

  EXPECT_THROW(BlockPlanner(grid, mesh, {}).plan(far, {}), std::invalid_argument);
  far.pop_back();
  EXPECT_THROW(BlockPlanner(grid, mesh, {}).plan(far, {}), std::invalid_argument);
}

TEST(BlockWindow, MustSufficeForTheFilterAndLieInTheGrid) {
  const Volume source = scenes::wavy_volume(scenes::unit_grid(8, 8, 8), PixelType::float32);
  const Mesh mesh = covering_mesh(source.grid);
  const VolumeView view(source);
  const auto start = [&](const WarpOptions& options) {
    Warper(std::span(&view, 1), mesh, options);
  };
  WarpOptions options;
  options.source_window = SourceWindow{{{0, 0, 0}, {8, 8, 4}}};
  EXPECT_NO_THROW(start(options));
  options.filter = Filter::bspline;
  EXPECT_THROW(start(options), std::invalid_argument);
  options.filter = Filter::linear;
  options.intensity = Intensity::conservative;
  EXPECT_THROW(start(options), std::invalid_argument);
  options.intensity = Intensity::value;
  options.overshoot = Overshoot::clamp;
  for (const std::vector<std::vector<double>>& bad :
       {std::vector<std::vector<double>>{}, {{0}}, {{0, 1}, {0, 1}}}) {
    options.source_window->ranges = bad;
    EXPECT_THROW(start(options), std::invalid_argument);
  }
  options.source_window->ranges = {{0, 1}};
  EXPECT_NO_THROW(start(options));
  for (const Region& bad : {Region{{0, 0, 0}, {8, 8, 9}}, Region{{0, 4, 0}, {8, 4, 8}},
                            Region{{-1, 0, 0}, {8, 8, 8}}}) {
    options.source_window->region = bad;
    EXPECT_THROW(start(options), std::invalid_argument);
  }
}
}  // namespace
}  // namespace tetwarp::test
