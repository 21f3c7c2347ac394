/// @file test_cli_mesh.cpp
/// `tetwarp mesh`: surfaces beside meshes, meshes of surfaces.
#include <gtest/gtest.h>

#include <string>
#include <tetwarp/scene_io.hpp>
#include <tetwarp/surface.hpp>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
using Words = std::vector<std::string>;

TEST(CliMesh, WritesTheIsosurfaceAndMakesAMeshOfIt) {
  const Scene scene;

  const CommandResult mesh = run_command(scene, {"mesh", "volume.vtkhdf", "-o", "m.vtkhdf",
                                                 "--threshold", "500", "--surface", "s.vtkhdf"});
  const CommandResult back =
      run_command(scene, {"mesh", "--from-surface", "s.vtkhdf", "-o", "b.vtkhdf", "--cells", "5"});

  EXPECT_EQ(mesh.exit_code, 0) << mesh.err;
  EXPECT_EQ(back.exit_code, 0) << back.err;
  const Surface surface = read_surface(scene / "s.vtkhdf");
  EXPECT_EQ(surface.points, make_isosurface(read_volume(scene / "volume.vtkhdf"), 500).points);
  EXPECT_LT(bind_points(MeshReader(scene / "b.vtkhdf").mesh(), surface.points).largest_distance,
            1e-9);
}

TEST(CliMesh, WritesTheBoundaryWithoutAThreshold) {
  const Scene scene;

  const CommandResult result = run_command(
      scene, {"mesh", "volume.vtkhdf", "-o", "m.vtkhdf", "--cells", "2", "--surface", "s.vtkhdf"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read_surface(scene / "s.vtkhdf").triangles,
            boundary_surface(MeshReader(scene / "m.vtkhdf").mesh()).triangles);
}

TEST(CliMesh, RefusesOptionsThatDoNotGoTogether) {
  const Scene scene;
  for (const auto& [words, text] : std::vector<std::pair<Words, std::string>>{
           {{"mesh", "-o", "m.vtkhdf"}, "--from-surface FILE"},
           {{"mesh", "volume.vtkhdf", "--from-surface", "s.vtkhdf", "-o", "m.vtkhdf"},
            "--from-surface FILE"},
           {{"mesh", "--from-surface", "s.vtkhdf", "--threshold", "1", "-o", "m.vtkhdf"},
            "--threshold: is not for --from-surface"},
           {{"mesh", "volume.vtkhdf", "--hexahedra", "--surface", "s.vtkhdf", "-o", "m.vtkhdf"},
            "leave out --hexahedra"},
           {{"mesh", "volume.vtkhdf", "--surface-triangles", "90", "-o", "m.vtkhdf"},
            "needs --surface and --threshold"}}) {
    const CommandResult result = run_command(scene, words);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
  }
}

TEST(CliMesh, ASurfaceThatIsNotClosedIsAnError) {
  const Scene scene;
  write_surface(scene / "open.vtkhdf", Surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}});

  const CommandResult result =
      run_command(scene, {"mesh", "--from-surface", "open.vtkhdf", "-o", "m.vtkhdf"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("open.vtkhdf: make_lattice_mesh: surface: is not closed"),
            std::string::npos)
      << result.err;
}
}  // namespace
}  // namespace tetwarp::test
