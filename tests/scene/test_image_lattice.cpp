/// @file test_image_lattice.cpp
/// Lattices around images: every voxel of the foreground has an owner, empty tetrahedra are
/// dropped.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <tetwarp/tetwarp.hpp>
#include <vector>

#include "host/scene/image_lattice.hpp"
#include "host/scene/voxel_owner.hpp"
#include "tests/scene/image_samples.hpp"
#include "tests/scene/surface_checks.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp {
namespace {
using scene_checks::ball_image;
using scene_checks::sum_of;
using scene_checks::uses_all_nodes;
using scene_checks::volumes_of;

Lattice cells_of(std::int64_t i, std::int64_t j, std::int64_t k) {
  return {.cells = std::array<std::int64_t, 3>{i, j, k}};
}

/// Per tetrahedron how many voxels of the foreground it owns; the last number: those without owner.
std::vector<std::int64_t> owned_voxels(const ImageGeometry& image, const TetMesh& mesh) {
  const Volume& volume = image.volume;
  const auto owners = voxel_owners(volume, {{0, 0, 0}, volume.grid.dims}, mesh);
  const auto samples = volume.samples<float>();
  std::vector<std::int64_t> owned(mesh.tets.size() + 1);
  for (std::size_t v = 0; v < owners.size(); ++v) {
    if (samples[v] < static_cast<float>(image.threshold)) continue;
    ++owned[owners[v] < 0 ? mesh.tets.size() : static_cast<std::size_t>(owners[v])];
  }
  return owned;
}

TEST(ImageLattice, OwnsEveryVoxelOfTheForegroundAndNothingElse) {
  const ImageGeometry image = ball_image({70, 68, 72}, 31.3);
  for (const Lattice& choice :
       {cells_of(3, 2, 3), cells_of(1, 1, 1), Lattice{.edge = 16.5}, Lattice{.tets = 160}}) {
    const ImageLattice lattice = make_image_lattice("bodies[0]", image, choice);

    const auto owned = owned_voxels(image, lattice.mesh);
    EXPECT_EQ(owned.back(), 0);
    EXPECT_GT(*std::min_element(owned.begin(), owned.end() - 1), 0);
    const auto volumes = volumes_of(lattice.mesh.nodes, lattice.mesh.tets);
    EXPECT_GT(*std::min_element(volumes.begin(), volumes.end()), 0);
    EXPECT_TRUE(uses_all_nodes(lattice.mesh.nodes.size(), lattice.mesh.tets));
  }
}

/// Small cells keep what shares a box of the foreground, and drop what only touches one.
TEST(ImageLattice, OfSmallCellsCoversTheBoxesOfTheForegroundAndNothingElse) {
  const ImageGeometry image = ball_image({9, 9, 9}, 2.6);
  const auto samples = image.volume.samples<float>();
  const auto voxels =
      static_cast<double>(std::ranges::count_if(samples, [](float sample) { return sample >= 0; }));

  for (const std::int64_t cells : {5, 10, 20}) {  // whole parts of a voxel
    const ImageLattice lattice =
        make_image_lattice("bodies[0]", image, cells_of(cells, cells, cells));
    EXPECT_TRUE(lattice.has_small_cells);
    EXPECT_NEAR(sum_of(volumes_of(lattice.mesh.nodes, lattice.mesh.tets)) / voxels, 1, 1e-12);
  }
}

TEST(ImageLattice, FollowsTheAxesOfTheGridAlsoMirrored) {
  ImageGeometry image = ball_image({12, 12, 12}, 5);
  image.volume.grid.direction = {0, -1, 0, 1, 0, 0, 0, 0, -1};
  image.volume.grid.origin = {100, -3, 7};
  image.volume.grid.spacing = {0.5, 2, 1};

  const ImageLattice lattice = make_image_lattice("bodies[0]", image, cells_of(3, 2, 4));

  EXPECT_EQ(owned_voxels(image, lattice.mesh).back(), 0);
  const auto volumes = volumes_of(lattice.mesh.nodes, lattice.mesh.tets);
  EXPECT_GT(*std::min_element(volumes.begin(), volumes.end()), 0);
}

TEST(ImageLattice, OfOneVoxelIsItsBox) {
  ImageGeometry image{make_volume({{5, 4, 3}}, PixelType::float32), 0.5};
  image.volume.samples<float>()[33] = 1;  // voxel (3, 2, 1)

  const ImageLattice lattice = make_image_lattice("bodies[0]", image, cells_of(1, 1, 1));

  EXPECT_EQ(lattice.mesh.tets.size(), 5u);
  EXPECT_NEAR(sum_of(volumes_of(lattice.mesh.nodes, lattice.mesh.tets)), 1, 1e-15);
  for (const Point3& node : lattice.mesh.nodes) {
    EXPECT_EQ(std::abs(node[0] - 3), 0.5);
    EXPECT_EQ(std::abs(node[1] - 2), 0.5);
    EXPECT_EQ(std::abs(node[2] - 1), 0.5);
  }
}

TEST(ImageLattice, OfPhantomsHasTheKnownCounts) {
  const ImageGeometry torso{make_phantom({128, 80, 61}), -1};
  const ImageGeometry fish{make_fish_phantom({51, 50, 128}, {4e-3, 4e-3, 4e-3}),
                           fish_phantom_threshold};
  const ImageGeometry orange{make_orange_phantom({66, 66, 53}, {1.2e-3, 1.2e-3, 1.5e-3}),
                             orange_phantom_threshold};
  const auto count = [](const ImageGeometry& image, const Lattice& choice) {
    return static_cast<double>(make_image_lattice("bodies[0]", image, choice).mesh.tets.size());
  };

  EXPECT_EQ(count(torso, cells_of(7, 5, 4)), 700);
  EXPECT_EQ(count(fish, cells_of(1, 1, 7)), 35);
  EXPECT_NEAR(count(orange, {.tets = 160}), 160, 6);
}

/// Samples and threshold that are shifted alike, beyond the digits of float64.
TEST(ImageLattice, SeesAllDigitsOf64Bits) {
  const std::int64_t shift = std::int64_t{1} << 60;
  const auto ball = [&](std::int64_t by) {
    const ImageGeometry floats = ball_image({11, 12, 13}, 4.5);
    ImageGeometry image{make_volume(floats.volume.grid, PixelType::int64), static_cast<double>(by)};
    const auto from = floats.volume.samples<float>();
    const auto to = image.volume.samples<std::int64_t>();
    for (std::size_t v = 0; v < from.size(); ++v) {
      to[v] = by + static_cast<std::int64_t>(std::floor(from[v]));
    }
    return make_image_lattice("bodies[0]", image, cells_of(3, 3, 3)).mesh;
  };

  const TetMesh mesh = ball(0), shifted = ball(shift);

  EXPECT_GT(mesh.tets.size(), 50U);
  EXPECT_EQ(shifted.tets, mesh.tets);
  EXPECT_EQ(shifted.nodes, mesh.nodes);
}

TEST(ImageLattice, NoForegroundIsAnError) {
  const ImageGeometry image{make_volume({{5, 4, 3}}, PixelType::uint8), 1};

  const std::string message =
      test::message_of([&] { make_image_lattice("bodies[2]", image, cells_of(1, 1, 1)); });

  EXPECT_EQ(message,
            "bodies[2].volume.threshold: no sample of 'values' is 1 or more, the largest is 0; "
            "lower the threshold");
}
}  // namespace
}  // namespace tetwarp
