/// @file paper_device.cuh
/// The method of Gascon et al. 2013 on a device: masks of grid points, a list of cells, one thread
/// a voxel. The paper makes the list on the processor; here all of it are kernels.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "bench/peers/paper_tet.hpp"
#include "bench/peers/peer.hpp"
#include "kernels/base/atomic_add.hpp"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp::bench {

/// A cell to draw.
struct PaperCell {
  std::int32_t tet;
  std::int32_t place;  ///< among the cells of its tetrahedron, along x fastest
};

/// One index = one tetrahedron: its maps and box; sums the cells.
struct PaperSetupOp {
  View<const double> deformed, rest;  ///< of nodes, shape [node_count, 3]
  View<const std::int32_t> nodes;     ///< shape [tet_count, 4]
  double origin[3];                   ///< of the output
  int dims[3];                        ///< of the output
  View<PaperTet> tets;                ///< out

  TETWARP_HD std::int64_t operator()(std::int64_t t) const {
    double now[4][3], before[4][3];
    for (int n = 0; n < 4; ++n) {
      const std::int64_t node = nodes[4 * t + n];
      for (int axis = 0; axis < 3; ++axis) {
        now[n][axis] = deformed[3 * node + axis] - origin[axis];
        before[n][axis] = rest[3 * node + axis];
      }
    }
    tets[t] = make_paper_tet(now, before, dims);
    return tets[t].cell_count();
  }
  TETWARP_HD void finish(std::int64_t, int) const {}
};

/// One index = one tetrahedron: sums the grid points.
struct PaperPointsOp {
  View<const PaperTet> tets;

  TETWARP_HD std::int64_t operator()(std::int64_t t) const { return tets[t].point_count(); }
  TETWARP_HD void finish(std::int64_t, int) const {}
};

/// One item = one grid point of a tetrahedron.
struct PaperMaskOp {
  View<const PaperTet> tets;
  View<std::uint8_t> masks;  ///< out

  TETWARP_HD void operator()(std::int64_t t, std::int64_t local, std::int64_t item) const {
    masks[item] = paper_mask(tets[t], local);
  }
};

/// One item = one cell of a tetrahedron, listed unless its masks reject it.
struct PaperListOp {
  View<const PaperTet> tets;
  GroupedSums points;              ///< first grid point of each tetrahedron
  View<const std::uint8_t> masks;  ///< empty: all cells are listed
  View<PaperCell> cells;           ///< out
  std::uint32_t* count;            ///< out

  TETWARP_HD void operator()(std::int64_t t, std::int64_t local, std::int64_t) const {
    if (masks.size > 0 && !paper_keeps(tets[t], masks.data + points[t], local)) return;
    cells[atomic_next(count)] = {static_cast<std::int32_t>(t), static_cast<std::int32_t>(local)};
  }
};

/// Blocks: one per listed cell. Threads: one per voxel. A voxel on a face that two tetrahedra share
/// is written twice.
__global__ void __launch_bounds__(cell_edge* cell_edge* cell_edge)
    paper_raster_kernel(View<const PaperTet> tets,
                        View<const PaperCell> cells,
                        PaperVolume<const float> source,
                        PaperVolume<float> output) {
  const PaperCell cell = cells[static_cast<std::int64_t>(blockIdx.x)];
  const PaperTet& tet = tets[cell.tet];
  const int nx = tet.cells(0), ny = tet.cells(1), thread = static_cast<int>(threadIdx.x);
  const int x = tet.low[0] + cell_edge * (cell.place % nx) + thread % cell_edge;
  const int y = tet.low[1] + cell_edge * (cell.place / nx % ny) + thread / cell_edge % cell_edge;
  const int z = tet.low[2] + cell_edge * (cell.place / nx / ny) + thread / cell_edge / cell_edge;
  if (x > tet.high[0] || y > tet.high[1] || z > tet.high[2]) return;
  const std::int64_t row = std::int64_t{z} * output.dims[1] + y;
  paper_draw(tet, source, x, y, z, output.samples + row * output.dims[0] + x);
}

/// Steps of the method with all arrays in memory of the device.
class PaperOnDevice {
 public:
  /// Copies the input. @param with_cells  see paper_method()
  PaperOnDevice(const PeerInput& input, bool with_cells)
      : exec_(0, StageClocks::off), with_cells_(with_cells) {
    const scenes::Scene& scene = input.scene;
    std::vector<double> deformed, rest;
    std::vector<std::int32_t> nodes;
    for (const Point3& p : scene.deformed) deformed.insert(deformed.end(), p.begin(), p.end());
    for (const Point3& p : scene.mesh.rest_positions) rest.insert(rest.end(), p.begin(), p.end());
    for (const auto& tet : scene.mesh.tets) nodes.insert(nodes.end(), tet.begin(), tet.end());
    exec_.put(deformed, deformed_);
    exec_.put(rest, rest_);
    exec_.put(nodes, nodes_);
    exec_.put(input.source, scene.source_grid.voxel_count(), source_);
    exec_.resize(output_, scene.output_grid.voxel_count());
    exec_.resize(tets_, static_cast<std::int64_t>(scene.mesh.tets.size()));
    exec_.resize(count_, 1);
    exec_.wait();
    std::copy(scene.output_grid.origin.begin(), scene.output_grid.origin.end(), origin_);
    const auto from = input.source_dims(), to = input.output_dims();
    std::copy_n(from.begin(), 3, source_dims_);
    std::copy_n(to.begin(), 3, output_dims_);
  }

  /// One step, as PeerStep; waits for the device.
  void step() {
    const View<const PaperTet> tets = const_view(tets_);
    PaperSetupOp setup{const_view(deformed_), const_view(rest_), const_view(nodes_), {}, {},
                       tets_.view()};
    std::copy_n(origin_, 3, setup.origin);
    std::copy_n(output_dims_, 3, setup.dims);
    exec_.make_zeros(output_, output_.view().size);
    exec_.make_zeros(count_, 1);
    const GroupedSums cell_sums = cell_sums_.of(tets.size), point_sums = point_sums_.of(tets.size);
    exec_.grouped_scan("paper/setup", tets.size, setup, cell_sums);
    exec_.grouped_scan("paper/setup", tets.size, PaperPointsOp{tets}, point_sums);
    const std::int64_t cells = exec_.load(cell_sums_.total(tets.size));
    exec_.resize(cells_, cells);
    exec_.resize(masks_, with_cells_ ? exec_.load(point_sums_.total(tets.size)) : 0);
    exec_.for_each_item("paper/mask", point_sums, masks_.view().size,
                        PaperMaskOp{tets, masks_.view()});
    exec_.for_each_item(
        "paper/cells", cell_sums, cells,
        PaperListOp{tets, point_sums, const_view(masks_), cells_.view(), count_.view().data});
    drawn_ = exec_.load(count_.view().data);
    if (drawn_ > 0) {
      PaperVolume<const float> source{source_.view().data, {}};
      PaperVolume<float> output{output_.view().data, {}};
      std::copy_n(source_dims_, 3, source.dims);
      std::copy_n(output_dims_, 3, output.dims);
      exec_.enqueue("paper/raster", paper_raster_kernel, dim3(drawn_),
                    dim3(cell_edge * cell_edge * cell_edge), 0, tets, const_view(cells_), source,
                    output);
    }
    exec_.wait();
  }

  /// Copies the output to the host.
  void get(float* output) const { exec_.get(output_.view(), output); }
  /// Cells that the last step drew.
  std::int64_t drawn() const { return drawn_; }

 private:
  /// Sums of counts of tetrahedra, and their memory.
  struct Sums {
    DeviceBuffer<std::int64_t> within, groups;

    GroupedSums of(std::int64_t count) {
      within.reserve(count + 1);
      groups.reserve(group_count(count) + 1);
      return {within.view(count + 1), groups.view(group_count(count) + 1), count + 1};
    }
    const std::int64_t* total(std::int64_t count) const {
      return groups.view(0).data + group_count(count);
    }
  };

  CudaExec exec_;
  bool with_cells_;
  DeviceVector<double> deformed_, rest_;
  DeviceVector<std::int32_t> nodes_;
  DeviceVector<float> source_, output_;
  DeviceVector<PaperTet> tets_;
  DeviceVector<PaperCell> cells_;
  DeviceVector<std::uint8_t> masks_;
  DeviceVector<std::uint32_t> count_;
  Sums cell_sums_, point_sums_;
  double origin_[3];
  int source_dims_[3], output_dims_[3];
  std::uint32_t drawn_ = 0;
};

}  // namespace tetwarp::bench
