#include <algorithm>
#include <vector>

#include "bench/peers/paper_tet.hpp"
#include "bench/peers/peer.hpp"

namespace tetwarp::bench {
namespace {
PaperTet paper_tet(const scenes::Scene& scene, std::size_t t, const int* dims) {
  double deformed[4][3], rest[4][3];
  for (std::size_t n = 0; n < 4; ++n) {
    const auto node = static_cast<std::size_t>(scene.mesh.tets[t][n]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      deformed[n][axis] = scene.deformed[node][axis] - scene.output_grid.origin[axis];
      rest[n][axis] = scene.mesh.rest_positions[node][axis];
    }
  }
  return make_paper_tet(deformed, rest, dims);
}

/// A box of voxels that one tetrahedron is tested against, both ends included.
struct Box {
  std::int32_t tet;
  int low[3], high[3];

  std::int64_t voxel_count() const {
    std::int64_t count = 1;
    for (int axis = 0; axis < 3; ++axis) count *= std::max(0, high[axis] - low[axis] + 1);
    return count;
  }
};

Box box_of(const PaperTet& tet, std::int32_t t) {
  Box box{t, {}, {}};
  std::copy_n(tet.low, 3, box.low);
  std::copy_n(tet.high, 3, box.high);
  return box;
}

/// The volumes of a step.
struct Volumes {
  PaperVolume<const float> source;
  PaperVolume<float> output;
};

Volumes volumes_of(const PeerInput& input) {
  Volumes volumes{{input.source, {}}, {input.output, {}}};
  const auto from = input.source_dims(), to = input.output_dims();
  std::copy_n(from.begin(), 3, volumes.source.dims);
  std::copy_n(to.begin(), 3, volumes.output.dims);
  return volumes;
}

/// @returns how many voxels pass
std::int64_t draw(const PaperTet& tet, const Box& box, const Volumes& volumes) {
  const int* const dims = volumes.output.dims;
  std::int64_t passed = 0;
  for (int k = box.low[2]; k <= box.high[2]; ++k) {
    for (int j = box.low[1]; j <= box.high[1]; ++j) {
      float* const row = volumes.output.samples + (std::int64_t{k} * dims[1] + j) * dims[0];
      for (int i = box.low[0]; i <= box.high[0]; ++i) {
        passed += paper_draw(tet, volumes.source, i, j, k, row + i);
      }
    }
  }
  return passed;
}

/// Appends the cells of a tetrahedron that its masks do not reject.
void add_cells(const PaperTet& tet,
               std::int32_t t,
               std::vector<std::uint8_t>& masks,
               std::vector<Box>& boxes) {
  masks.resize(static_cast<std::size_t>(tet.point_count()));
  for (std::size_t point = 0; point < masks.size(); ++point) {
    masks[point] = paper_mask(tet, static_cast<std::int64_t>(point));
  }
  for (std::int64_t cell = 0; cell < tet.cell_count(); ++cell) {
    if (!paper_keeps(tet, masks.data(), cell)) continue;
    Box box{t, {}, {}};
    const std::int64_t nx = tet.cells(0), ny = tet.cells(1);
    const std::int64_t place[3] = {cell % nx, cell / nx % ny, cell / nx / ny};
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = tet.low[axis] + static_cast<int>(place[axis]) * cell_edge;
      box.high[axis] = std::min(tet.high[axis], box.low[axis] + cell_edge - 1);
    }
    boxes.push_back(box);
  }
}

std::vector<Box> cells_of(const std::vector<PaperTet>& tets, int threads) {
  std::vector<Box> boxes;
#pragma omp parallel num_threads(threads)
  {
    std::vector<std::uint8_t> masks;
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

PeerStep paper_method(const PeerInput& input, bool with_cells, PaperCounts* counts) {
  return [input, with_cells, counts] {
    std::vector<PaperTet> tets(input.tet_count());
    const auto count = static_cast<std::int64_t>(tets.size());
    const Volumes volumes = volumes_of(input);
    fill_background(input);
#pragma omp parallel for schedule(static) num_threads(input.threads)
    for (std::int64_t t = 0; t < count; ++t) {
      tets[static_cast<std::size_t>(t)] =
          paper_tet(input.scene, static_cast<std::size_t>(t), volumes.output.dims);
    }
    std::vector<Box> boxes;
    if (with_cells) {
      boxes = cells_of(tets, input.threads);
    } else {
      for (std::int64_t t = 0; t < count; ++t) {
        boxes.push_back(box_of(tets[static_cast<std::size_t>(t)], static_cast<std::int32_t>(t)));
      }
    }
    const int share = with_cells ? 64 : 1;
    std::int64_t tested = 0, passed = 0;
#pragma omp parallel for schedule(dynamic, share) num_threads(input.threads) reduction(+ : tested, passed)
    for (std::int64_t b = 0; b < static_cast<std::int64_t>(boxes.size()); ++b) {
      const Box& box = boxes[static_cast<std::size_t>(b)];
      tested += box.voxel_count();
      passed += draw(tets[static_cast<std::size_t>(box.tet)], box, volumes);
    }
    if (counts == nullptr) return;
    *counts = {0, static_cast<std::int64_t>(boxes.size()), tested, passed};
    for (const PaperTet& tet : tets) counts->cells += tet.cell_count();
  };
}

}  // namespace tetwarp::bench
