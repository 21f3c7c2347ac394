#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/peers/peer.hpp"

namespace tetwarp::bench {
namespace {
constexpr int cell_edge = 8;

/// Rows of the barycentric map, rest positions as columns, and the bounding box.
struct PaperTet {
  float barycentric[4][4];
  float rest[3][4];
  int low[3], high[3];
};

PaperTet paper_tet(const scenes::Scene& scene, std::size_t t) {
  const PeerTet tet = peer_tet(scene, t);
  PaperTet result;
  double sum[4] = {0, 0, 0, 0};
  for (int n = 0; n < 3; ++n) {
    double offset = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double weight = tet.weights[n][axis];
      result.barycentric[n + 1][axis] = static_cast<float>(weight);
      sum[axis] += weight;
      offset -= weight * tet.deformed[0][axis];
    }
    result.barycentric[n + 1][3] = static_cast<float>(offset);
    sum[3] += offset;
  }
  for (int axis = 0; axis < 3; ++axis) result.barycentric[0][axis] = static_cast<float>(-sum[axis]);
  result.barycentric[0][3] = static_cast<float>(1 - sum[3]);
  for (int axis = 0; axis < 3; ++axis) {
    for (int n = 0; n < 4; ++n) result.rest[axis][n] = static_cast<float>(tet.rest[n][axis]);
  }
  std::copy_n(tet.low, 3, result.low);
  std::copy_n(tet.high, 3, result.high);
  return result;
}

float barycentric_at(const PaperTet& tet, int node, float x, float y, float z) {
  const float* const row = tet.barycentric[node];
  return row[0] * x + row[1] * y + row[2] * z + row[3];
}

float trilinear(const float* samples, const std::array<int, 3>& dims, const float (&x)[3]) {
  float fraction[3];
  int low[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float inside = std::min(std::max(x[axis], 0.0f), static_cast<float>(dims[axis] - 1));
    low[axis] = std::min(static_cast<int>(inside), dims[axis] - 2);
    fraction[axis] = inside - static_cast<float>(low[axis]);
  }
  const std::int64_t row = dims[0], slice = row * dims[1];
  const float* const p = samples + low[2] * slice + low[1] * row + low[0];
  const auto along_x = [&](std::int64_t at) { return p[at] + fraction[0] * (p[at + 1] - p[at]); };
  const auto along_y = [&](std::int64_t at) {
    const float a = along_x(at);
    return a + fraction[1] * (along_x(at + row) - a);
  };
  const float a = along_y(0);
  return a + fraction[2] * (along_y(slice) - a);
}

/// A box of voxels that one tetrahedron is tested against, both ends included.
struct Box {
  std::int32_t tet;
  int low[3], high[3];
};

void draw(const PaperTet& tet, const int* low, const int* high, const PeerInput& input) {
  const auto source_dims = input.source_dims(), dims = input.output_dims();
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      float* const row = input.output + (std::int64_t{k} * dims[1] + j) * dims[0];
      for (int i = low[0]; i <= high[0]; ++i) {
        float b[4];
        for (int n = 0; n < 4; ++n) {
          b[n] = barycentric_at(tet, n, static_cast<float>(i), static_cast<float>(j),
                                static_cast<float>(k));
        }
        if (b[0] < 0 || b[1] < 0 || b[2] < 0 || b[3] < 0) continue;
        float x[3];
        for (int axis = 0; axis < 3; ++axis) {
          const float* const rest = tet.rest[axis];
          x[axis] = rest[0] * b[0] + rest[1] * b[1] + rest[2] * b[2] + rest[3] * b[3];
        }
        row[i] = trilinear(input.source, source_dims, x);
      }
    }
  }
}

/// Bit 2n: below 0, bit 2n + 1: above 1, of barycentric coordinate n at a corner.
unsigned mask_at(const PaperTet& tet, int x, int y, int z) {
  unsigned mask = 0;
  for (int n = 0; n < 4; ++n) {
    const float b =
        barycentric_at(tet, n, static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    mask |= static_cast<unsigned>(b < 0) << (2 * n) | static_cast<unsigned>(b > 1) << (2 * n + 1);
  }
  return mask;
}

/// Appends the cells of a tetrahedron whose eight corners share no mask bit.
void add_cells(const PaperTet& tet,
               std::int32_t t,
               std::vector<unsigned char>& masks,
               std::vector<Box>& boxes) {
  int corners[3];
  for (int axis = 0; axis < 3; ++axis) {
    if (tet.high[axis] < tet.low[axis]) return;
    corners[axis] = (tet.high[axis] - tet.low[axis]) / cell_edge + 2;
  }
  masks.clear();
  for (int z = 0; z < corners[2]; ++z) {
    for (int y = 0; y < corners[1]; ++y) {
      for (int x = 0; x < corners[0]; ++x) {
        masks.push_back(static_cast<unsigned char>(mask_at(tet, tet.low[0] + x * cell_edge,
                                                           tet.low[1] + y * cell_edge,
                                                           tet.low[2] + z * cell_edge)));
      }
    }
  }
  for (int z = 0; z + 1 < corners[2]; ++z) {
    for (int y = 0; y + 1 < corners[1]; ++y) {
      for (int x = 0; x + 1 < corners[0]; ++x) {
        unsigned shared = 255;
        for (int c = 0; c < 8; ++c) {
          const int at =
              ((z + (c >> 2)) * corners[1] + y + (c >> 1 & 1)) * corners[0] + x + (c & 1);
          shared &= masks[static_cast<std::size_t>(at)];
        }
        if (shared != 0) continue;
        Box box{t, {}, {}};
        const int cell[3] = {x, y, z};
        for (int axis = 0; axis < 3; ++axis) {
          box.low[axis] = tet.low[axis] + cell[axis] * cell_edge;
          box.high[axis] = std::min(tet.high[axis], box.low[axis] + cell_edge - 1);
        }
        boxes.push_back(box);
      }
    }
  }
}

std::vector<Box> cells_of(const std::vector<PaperTet>& tets, int threads) {
  std::vector<Box> boxes;
#pragma omp parallel num_threads(threads)
  {
    std::vector<unsigned char> masks;
    std::vector<Box> own;
#pragma omp for schedule(dynamic, 8) nowait
    for (std::int64_t t = 0; t < static_cast<std::int64_t>(tets.size()); ++t) {
      add_cells(tets[static_cast<std::size_t>(t)], static_cast<std::int32_t>(t), masks, own);
    }
#pragma omp critical
    boxes.insert(boxes.end(), own.begin(), own.end());
  }
  return boxes;
}
}  // namespace

PeerStep paper_method(const PeerInput& input, bool with_cells) {
  return [input, with_cells] {
    std::vector<PaperTet> tets(input.tet_count());
    const auto count = static_cast<std::int64_t>(tets.size());
    fill_background(input);
#pragma omp parallel for schedule(static) num_threads(input.threads)
    for (std::int64_t t = 0; t < count; ++t) {
      tets[static_cast<std::size_t>(t)] = paper_tet(input.scene, static_cast<std::size_t>(t));
    }
    if (!with_cells) {
#pragma omp parallel for schedule(dynamic) num_threads(input.threads)
      for (std::int64_t t = 0; t < count; ++t) {
        const PaperTet& tet = tets[static_cast<std::size_t>(t)];
        draw(tet, tet.low, tet.high, input);
      }
      return;
    }
    const std::vector<Box> boxes = cells_of(tets, input.threads);
#pragma omp parallel for schedule(dynamic, 64) num_threads(input.threads)
    for (std::int64_t b = 0; b < static_cast<std::int64_t>(boxes.size()); ++b) {
      const Box& box = boxes[static_cast<std::size_t>(b)];
      draw(tets[static_cast<std::size_t>(box.tet)], box.low, box.high, input);
    }
  };
}

}  // namespace tetwarp::bench
