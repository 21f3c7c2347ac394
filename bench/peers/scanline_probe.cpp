#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/peers/avx512_sample.hpp"
#include "bench/peers/peer.hpp"

namespace tetwarp::bench {
namespace {
/// Where a face plane crosses a row (j, k): at i = along_j j + along_k k + offset.
struct Face {
  double along_j, along_k, offset;
  enum { from, up_to, inside_if_positive, inside_if_negative } side;  ///< the last two: parallel
};

struct ScanTet {
  Face faces[4];
  float map[3][4];  ///< source position of (i, j, k, 1)
  int low[3], high[3];
};

/// The plane of the face opposite to a node. Corners are sorted by node, so that both neighbors
/// compute the same crossing.
Face face_of(const PeerTet& tet, const std::array<std::int32_t, 4>& nodes, std::size_t opposite) {
  std::size_t corner[3], count = 0;
  for (std::size_t n = 0; n < 4; ++n) {
    if (n != opposite) corner[count++] = n;
  }
  std::sort(corner, corner + 3, [&](std::size_t a, std::size_t b) { return nodes[a] < nodes[b]; });
  const double* const a = tet.deformed[corner[0]];
  double u[3], v[3], normal[3], plane = 0, height = 0;
  for (int axis = 0; axis < 3; ++axis) {
    u[axis] = tet.deformed[corner[1]][axis] - a[axis];
    v[axis] = tet.deformed[corner[2]][axis] - a[axis];
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    normal[axis] = u[x] * v[y] - u[y] * v[x];
    plane -= normal[axis] * a[axis];
    height += normal[axis] * (tet.deformed[opposite][axis] - a[axis]);
  }
  if (normal[0] != 0) {
    const bool is_from = (normal[0] > 0) == (height > 0);
    return {-normal[1] / normal[0], -normal[2] / normal[0], -plane / normal[0],
            is_from ? Face::from : Face::up_to};
  }
  const bool flipped = normal[1] < 0 || (normal[1] == 0 && normal[2] < 0);
  const double sign = flipped ? -1 : 1;
  return {sign * normal[1], sign * normal[2], sign * plane,
          (height > 0) != flipped ? Face::inside_if_positive : Face::inside_if_negative};
}

ScanTet scan_tet(const scenes::Scene& scene, std::size_t t) {
  const PeerTet tet = peer_tet(scene, t);
  ScanTet result;
  for (std::size_t face = 0; face < 4; ++face) {
    result.faces[face] = face_of(tet, scene.mesh.tets[t], face);
  }
  for (int row = 0; row < 3; ++row) {
    double offset = tet.rest[0][row];
    for (int axis = 0; axis < 3; ++axis) {
      double slope = 0;
      for (int n = 0; n < 3; ++n) {
        slope += (tet.rest[n + 1][row] - tet.rest[0][row]) * tet.weights[n][axis];
      }
      result.map[row][axis] = static_cast<float>(slope);
      offset -= slope * tet.deformed[0][axis];
    }
    result.map[row][3] = static_cast<float>(offset);
  }
  std::copy_n(tet.low, 3, result.low);
  std::copy_n(tet.high, 3, result.high);
  return result;
}

void draw(const ScanTet& tet, const PeerInput& input, const Sampler16& sampler) {
  const auto dims = input.output_dims();
  const float step[3] = {tet.map[0][0], tet.map[1][0], tet.map[2][0]};
  for (int k = tet.low[2]; k <= tet.high[2]; ++k) {
    for (int j = tet.low[1]; j <= tet.high[1]; ++j) {
      double from = 0, to = dims[0];
      for (const Face& face : tet.faces) {
        const double at = face.along_j * j + face.along_k * k + face.offset;
        if (face.side == Face::from) from = std::max(from, at);
        if (face.side == Face::up_to) to = std::min(to, at);
        if (face.side == Face::inside_if_positive && !(at >= 0)) to = -1;
        if (face.side == Face::inside_if_negative && !(at < 0)) to = -1;
      }
      if (!(from < to)) continue;
      float base[3];
      for (int row = 0; row < 3; ++row) {
        base[row] = tet.map[row][1] * static_cast<float>(j) +
                    tet.map[row][2] * static_cast<float>(k) + tet.map[row][3];
      }
      const std::int64_t line = std::int64_t{k} * dims[1] + j;
      sample_row16(sampler, base, step, static_cast<int>(std::ceil(from)),
                   static_cast<int>(std::ceil(to)), input.output + line * dims[0]);
    }
  }
}
}  // namespace

PeerStep scanline_probe(const PeerInput& input) {
  return [input] {
    const Sampler16 sampler(input.source, input.source_dims());
    const auto tets = static_cast<std::int64_t>(input.tet_count());
    const int chunk = tets < 2000 ? 1 : 16;
    std::vector<ScanTet> scans(input.tet_count());
    fill_background(input);
#pragma omp parallel num_threads(input.threads)
    {
#pragma omp for schedule(static)
      for (std::int64_t t = 0; t < tets; ++t) {
        scans[static_cast<std::size_t>(t)] = scan_tet(input.scene, static_cast<std::size_t>(t));
      }
#pragma omp for schedule(dynamic, chunk)
      for (std::int64_t t = 0; t < tets; ++t) {
        draw(scans[static_cast<std::size_t>(t)], input, sampler);
      }
    }
  };
}

}  // namespace tetwarp::bench
