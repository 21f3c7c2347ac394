/// @file cli_scene.hpp
/// Small input files for the tests of the command.
#pragma once
#include <cstdint>
#include <string>
#include <tetwarp/io.hpp>
#include <vector>

#include "tests/support/run_command.hpp"

namespace tetwarp::test {

/// 12 x 10 x 8 voxels of spacing 2 with a ramp 1, 2, 3... of type T.
template <class T>
Volume ramp_volume(const std::string& name = "density") {
  Grid grid;
  grid.dims = {12, 10, 8};
  grid.origin = {5, -3, 100};
  grid.spacing = {2, 2, 2};
  Volume volume = make_volume(grid, pixel_type_of<T>(), 1, name);
  T value = 0;
  for (T& sample : volume.samples<T>()) sample = ++value;
  return volume;
}

/// A box of five tetrahedra from half a voxel before the first to half a voxel behind the last
/// voxel center of the ramp volume.
inline Mesh box_mesh() {
  Mesh mesh;
  for (int node = 0; node < 8; ++node) {
    mesh.rest_positions.push_back({(node & 1) != 0 ? 28.0 : 4.0, (node & 2) != 0 ? 16.0 : -4.0,
                                   (node & 4) != 0 ? 115.0 : 99.0});
  }
  mesh.tets = {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}};
  return mesh;
}

/// Displacements of the box by `shift` voxels along i, one step per entry.
inline std::vector<std::vector<Point3>> shifts(const std::vector<double>& voxels) {
  std::vector<std::vector<Point3>> steps;
  steps.reserve(voxels.size());
  for (const double shift : voxels) {
    steps.emplace_back(box_mesh().rest_positions.size(), Point3{2 * shift, 0, 0});
  }
  return steps;
}

/// A folder with volume.vtkhdf and mesh.vtkhdf: the ramp, and the box shifted by 0, 1, 1 and 3
/// voxels at times 0, 0.5, 1 and 1.5.
class Scene : public TemporaryFolder {
 public:
  Scene() {
    const Volume volume = ramp_volume<float>();
    write_volumes(*this / "volume.vtkhdf", {&volume});
    write_mesh(*this / "mesh.vtkhdf", box_mesh(), shifts({0, 1, 1, 3}), {0, 0.5, 1, 1.5});
  }

  const std::vector<std::string> inputs{"mesh.vtkhdf", "volume.vtkhdf"};  ///< names() at first

  /// Runs `tetwarp warp volume.vtkhdf mesh.vtkhdf` with more words.
  CommandResult warp(std::vector<std::string> words, const RunOptions& options = {}) const {
    words.insert(words.begin(), {"warp", "volume.vtkhdf", "mesh.vtkhdf"});
    return run_command(*this, words, options);
  }
};

}  // namespace tetwarp::test
