/// @file lattice_mesh.cpp
/// Lattice meshes: cubic cells around the foreground, as hexahedra or five tetrahedra each.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <tetwarp/make.hpp>
#include <vector>

#include "host/base/index_space.hpp"
#include "host/base/lattice_cells.hpp"
#include "host/base/pixel_dispatch.hpp"
#include "host/base/sample_level.hpp"

namespace tetwarp {
namespace {
/// Finds the foreground of a volume, one row of voxels per call.
class ForegroundRows {
 public:
  ForegroundRows(const Volume& volume, std::optional<double> threshold)
      : volume_(volume),
        threshold_(threshold),
        flags_(static_cast<std::size_t>(volume.grid.dims[0])) {}

  /// Per voxel of row (j, k), 1: foreground. Valid until the next call.
  const std::vector<std::uint8_t>& row(std::int64_t j, std::int64_t k) {
    if (!threshold_) {
      std::fill(flags_.begin(), flags_.end(), std::uint8_t{1});
      return flags_;
    }
    with_pixel_type(volume_.type, [&]<class T>(T) {
      const std::size_t components = static_cast<std::size_t>(volume_.components);
      const std::size_t row_index = static_cast<std::size_t>(k * volume_.grid.dims[1] + j);
      const T* sample = volume_.samples<T>().data() + row_index * flags_.size() * components;
      if (components == 1) {
        for (std::size_t i = 0; i < flags_.size(); ++i) flags_[i] = is_above(sample[i]);
        return;
      }
      for (std::size_t i = 0; i < flags_.size(); ++i, sample += components) {
        flags_[i] = std::any_of(sample, sample + components, [&](T s) { return is_above(s); });
      }
    });
    return flags_;
  }

 private:
  template <class T>
  bool is_above(T sample) const {
    return level_of(sample, *threshold_) > 0;
  }

  const Volume& volume_;
  std::optional<double> threshold_;
  std::vector<std::uint8_t> flags_;
};

void include(Region& box, std::size_t axis, std::int64_t begin, std::int64_t end) {
  box.begin[axis] = std::min(box.begin[axis], begin);
  box.end[axis] = std::max(box.end[axis], end);
}

/// The box of the foreground.
Region foreground_box(const Volume& volume, const LatticeOptions& options) {
  if (!options.threshold) return {{0, 0, 0}, volume.grid.dims};
  Region box{volume.grid.dims, {0, 0, 0}};
  ForegroundRows rows(volume, options.threshold);
  for (std::int64_t k = 0; k < volume.grid.dims[2]; ++k) {
    for (std::int64_t j = 0; j < volume.grid.dims[1]; ++j) {
      const auto& row = rows.row(j, k);
      const auto first = std::find(row.begin(), row.end(), 1);
      if (first == row.end()) continue;
      const auto last = std::find(row.rbegin(), row.rend(), 1);
      include(box, 0, first - row.begin(), row.rend() - last);
      include(box, 1, j, j + 1);
      include(box, 2, k, k + 1);
    }
  }
  if (box.end[2] == 0) {
    throw std::invalid_argument("make_lattice_mesh: no voxel of '" + volume.name + "' is above " +
                                std::to_string(*options.threshold) + "; lower the threshold");
  }
  return box;
}

/// Cubes whose positions are index positions of the grid.
LatticeFrame place_cells(const Grid& grid, const Region& box, int cells_along_longest) {
  Bounds bounds;
  Point3 step{}, length{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bounds.low[axis] = static_cast<double>(box.begin[axis]) - 0.5;
    bounds.high[axis] = static_cast<double>(box.end[axis]) - 0.5;
    step[axis] = step_length(grid, axis);
    length[axis] = (bounds.high[axis] - bounds.low[axis]) * step[axis];
  }
  const double edge = *std::max_element(length.begin(), length.end()) / cells_along_longest;
  const LatticeFrame frame =
      covering_frame(bounds, {edge / step[0], edge / step[1], edge / step[2]}, 0);
  double tet_count = 5;
  for (const std::int64_t count : frame.cells) tet_count *= static_cast<double>(count);
  if (tet_count > std::numeric_limits<std::int32_t>::max()) {
    throw std::invalid_argument("make_lattice_mesh: " + std::to_string(cells_along_longest) +
                                " cells along the longest side make 2^31 or more tetrahedra");
  }
  return frame;
}

/// Cells [begin, end) that overlap the box of a voxel, half a voxel around its center.
struct CellRange {
  std::int64_t begin;
  std::int64_t end;
};

std::vector<CellRange> cells_of_voxels(const LatticeFrame& lattice,
                                       const Region& box,
                                       std::size_t axis) {
  std::vector<CellRange> ranges;
  const auto last = static_cast<double>(lattice.cells[axis] - 1);
  for (std::int64_t v = box.begin[axis]; v < box.end[axis]; ++v) {
    const double low = static_cast<double>(v) - 0.5 - lattice.start[axis];
    // An overlap within rounding does not count.
    const double first_cell = std::floor(low / lattice.edge[axis] + 1e-9);
    const double last_cell = std::ceil((low + 1) / lattice.edge[axis] - 1e-9) - 1;
    ranges.push_back({static_cast<std::int64_t>(std::clamp(first_cell, 0.0, last)),
                      static_cast<std::int64_t>(std::clamp(last_cell, 0.0, last)) + 1});
  }
  return ranges;
}

std::vector<std::uint8_t> occupied_cells(const Volume& volume,
                                         const LatticeOptions& options,
                                         const Region& box,
                                         const LatticeFrame& lattice) {
  const auto cells_of_i = cells_of_voxels(lattice, box, 0);
  const auto cells_of_j = cells_of_voxels(lattice, box, 1);
  const auto cells_of_k = cells_of_voxels(lattice, box, 2);
  std::vector<std::uint8_t> occupied(lattice.cell_count());
  std::vector<std::uint8_t> in_row(static_cast<std::size_t>(lattice.cells[0]));
  ForegroundRows rows(volume, options.threshold);
  for (std::size_t k = 0; k < cells_of_k.size(); ++k) {
    for (std::size_t j = 0; j < cells_of_j.size(); ++j) {
      const std::uint8_t* flags = rows.row(box.begin[1] + static_cast<std::int64_t>(j),
                                           box.begin[2] + static_cast<std::int64_t>(k))
                                      .data() +
                                  box.begin[0];
      std::fill(in_row.begin(), in_row.end(), std::uint8_t{0});
      for (std::size_t i = 0; i < cells_of_i.size(); ++i) {
        if (!flags[i]) continue;
        const auto [begin, end] = cells_of_i[i];
        std::fill(in_row.begin() + begin, in_row.begin() + end, std::uint8_t{1});
      }
      for (std::int64_t c = cells_of_k[k].begin; c < cells_of_k[k].end; ++c) {
        for (std::int64_t b = cells_of_j[j].begin; b < cells_of_j[j].end; ++b) {
          std::uint8_t* target = occupied.data() + lattice.cell_id(0, b, c);
          for (std::size_t a = 0; a < in_row.size(); ++a) target[a] |= in_row[a];
        }
      }
    }
  }
  return occupied;
}

bool is_mirrored(const Grid& grid) {
  return Eigen::Matrix3d(grid.direction.data()).determinant() < 0;
}
}  // namespace

Mesh make_lattice_mesh(const Volume& volume, const LatticeOptions& options) {
  check_grid(volume.grid, "make_lattice_mesh: volume '" + volume.name + "'");
  static_cast<void>(VolumeView(volume));  // throws unless the samples fit the grid
  if (options.cells < 1) {
    throw std::invalid_argument("make_lattice_mesh: " + std::to_string(options.cells) +
                                " cells, expected at least 1");
  }
  const Region box = foreground_box(volume, options);
  const LatticeFrame lattice = place_cells(volume.grid, box, options.cells);
  const auto occupied = occupied_cells(volume, options, box, lattice);
  Mesh mesh = mesh_of_cells(
      lattice, occupied, options.hexahedra ? LatticeDivision::one_hex : LatticeDivision::five_tets);
  for (Point3& x : mesh.rest_positions) x = volume.grid.world_of(x);
  if (is_mirrored(volume.grid)) {
    for (auto& tet : mesh.tets) std::swap(tet[2], tet[3]);
    for (auto& hex : mesh.hexes) {
      std::swap(hex[1], hex[3]);
      std::swap(hex[5], hex[7]);
    }
  }
  return mesh;
}

}  // namespace tetwarp
