#include "bench/peers/peer.hpp"

#include <algorithm>
#include <cmath>

namespace tetwarp::bench {

PeerTet peer_tet(const scenes::Scene& scene, std::size_t tet) {
  PeerTet result;
  double edge[3][3];  // [axis][node - 1], from node 0
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t n = 0; n < 4; ++n) {
      const auto node = static_cast<std::size_t>(scene.mesh.tets[tet][n]);
      result.deformed[n][axis] = scene.deformed[node][axis] - scene.output_grid.origin[axis];
      result.rest[n][axis] = scene.mesh.rest_positions[node][axis];
      if (n > 0) edge[axis][n - 1] = result.deformed[n][axis] - result.deformed[0][axis];
    }
    const auto& p = result.deformed;
    const auto [low, high] = std::minmax({p[0][axis], p[1][axis], p[2][axis], p[3][axis]});
    const int last = static_cast<int>(scene.output_grid.dims[axis]) - 1;
    result.low[axis] = std::max(0, static_cast<int>(std::ceil(low)));
    result.high[axis] = std::min(last, static_cast<int>(std::floor(high)));
  }
  const auto minor = [&](int row, int column) {  // of the edge matrix, with its sign
    const int a = (row + 1) % 3, b = (row + 2) % 3, x = (column + 1) % 3, y = (column + 2) % 3;
    return edge[a][x] * edge[b][y] - edge[a][y] * edge[b][x];
  };
  const double determinant =
      edge[0][0] * minor(0, 0) + edge[0][1] * minor(0, 1) + edge[0][2] * minor(0, 2);
  for (int n = 0; n < 3; ++n) {
    for (int axis = 0; axis < 3; ++axis) result.weights[n][axis] = minor(axis, n) / determinant;
  }
  return result;
}

void fill_background(const PeerInput& input) {
  constexpr std::int64_t piece = 65536;
  const std::int64_t voxels = input.scene.output_grid.voxel_count();
#pragma omp parallel for schedule(static) num_threads(input.threads)
  for (std::int64_t at = 0; at < voxels; at += piece) {
    std::fill(input.output + at, input.output + std::min(at + piece, voxels), 0.0f);
  }
}

}  // namespace tetwarp::bench
