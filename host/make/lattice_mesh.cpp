/// @file lattice_mesh.cpp
/// Lattice meshes: cubic cells around the foreground, as hexahedra or five tetrahedra each.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <tetwarp/make.hpp>
#include <vector>

#include "host/base/five_tets.hpp"
#include "host/base/pixel_dispatch.hpp"

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
    return static_cast<double>(sample) > *threshold_;
  }

  const Volume& volume_;
  std::optional<double> threshold_;
  std::vector<std::uint8_t> flags_;
};

/// Voxels [begin, end) per axis.
struct Box {
  std::array<std::int64_t, 3> begin;
  std::array<std::int64_t, 3> end;
};

void include(Box& box, std::size_t axis, std::int64_t begin, std::int64_t end) {
  box.begin[axis] = std::min(box.begin[axis], begin);
  box.end[axis] = std::max(box.end[axis], end);
}

Box foreground_box(const Volume& volume, const LatticeOptions& options) {
  if (!options.threshold) return {{0, 0, 0}, volume.grid.dims};
  Box box{volume.grid.dims, {0, 0, 0}};
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

/// Positions of the cells: lattice node (a, b, c) is at index position start + edge * (a, b, c).
struct Lattice {
  std::array<std::int64_t, 3> cells;
  Point3 start;  ///< [index]
  Point3 edge;   ///< [index]

  std::size_t cell_count() const {
    return static_cast<std::size_t>(cells[0] * cells[1] * cells[2]);
  }
  std::int64_t cell_id(std::int64_t a, std::int64_t b, std::int64_t c) const {
    return (c * cells[1] + b) * cells[0] + a;
  }
  std::int64_t node_id(std::int64_t a, std::int64_t b, std::int64_t c) const {
    return (c * (cells[1] + 1) + b) * (cells[0] + 1) + a;
  }
};

/// Length of one step along a grid axis [world].
double step_length(const Grid& grid, std::size_t axis) {
  const auto& d = grid.direction;
  return grid.spacing[axis] * std::hypot(d[axis], d[3 + axis], d[6 + axis]);
}

Lattice place_cells(const Grid& grid, const Box& box, int cells_along_longest) {
  Point3 length;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    length[axis] = static_cast<double>(box.end[axis] - box.begin[axis]) * step_length(grid, axis);
  }
  const double edge = *std::max_element(length.begin(), length.end()) / cells_along_longest;
  Lattice lattice;
  double tet_count = 5;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Lengths within rounding of a whole number of edges need no further cell.
    const double count = std::max(1.0, std::ceil(length[axis] / edge - 1e-9));
    const double middle = 0.5 * static_cast<double>(box.begin[axis] + box.end[axis] - 1);
    lattice.cells[axis] = static_cast<std::int64_t>(count);
    lattice.edge[axis] = edge / step_length(grid, axis);
    lattice.start[axis] = middle - 0.5 * count * lattice.edge[axis];
    tet_count *= count;
  }
  if (tet_count > std::numeric_limits<std::int32_t>::max()) {
    throw std::invalid_argument("make_lattice_mesh: " + std::to_string(cells_along_longest) +
                                " cells along the longest side make 2^31 or more tetrahedra");
  }
  return lattice;
}

/// Cells [begin, end) that overlap the box of a voxel, half a voxel around its center.
struct CellRange {
  std::int64_t begin;
  std::int64_t end;
};

std::vector<CellRange> cells_of_voxels(const Lattice& lattice, const Box& box, std::size_t axis) {
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
                                         const Box& box,
                                         const Lattice& lattice) {
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

/// Calls visit(a, b, c) for the occupied cells.
template <class Visit>
void for_occupied(const Lattice& lattice, const std::vector<std::uint8_t>& occupied, Visit visit) {
  for (std::int64_t c = 0; c < lattice.cells[2]; ++c) {
    for (std::int64_t b = 0; b < lattice.cells[1]; ++b) {
      for (std::int64_t a = 0; a < lattice.cells[0]; ++a) {
        if (occupied[static_cast<std::size_t>(lattice.cell_id(a, b, c))]) visit(a, b, c);
      }
    }
  }
}

/// The mesh of the occupied cells and their nodes, in lattice order.
Mesh mesh_of_cells(const Grid& grid,
                   const Lattice& lattice,
                   const std::vector<std::uint8_t>& occupied,
                   bool hexahedra) {
  const auto& cells = lattice.cells;
  std::vector<std::int32_t> number(static_cast<std::size_t>(lattice.node_id(0, 0, cells[2] + 1)),
                                   -1);
  const auto corner_of = [&](std::int64_t a, std::int64_t b, std::int64_t c,
                             int corner) -> std::int32_t& {
    return number[static_cast<std::size_t>(
        lattice.node_id(a + (corner & 1), b + (corner >> 1 & 1), c + (corner >> 2)))];
  };
  for_occupied(lattice, occupied, [&](std::int64_t a, std::int64_t b, std::int64_t c) {
    for (int corner = 0; corner < 8; ++corner) corner_of(a, b, c, corner) = 0;
  });
  Mesh mesh;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] < 0) continue;
    const auto node = static_cast<std::int64_t>(n);
    const std::array<std::int64_t, 3> abc{node % (cells[0] + 1),
                                          node / (cells[0] + 1) % (cells[1] + 1),
                                          node / (cells[0] + 1) / (cells[1] + 1)};
    Point3 index;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      index[axis] = lattice.start[axis] + lattice.edge[axis] * static_cast<double>(abc[axis]);
    }
    number[n] = static_cast<std::int32_t>(mesh.rest_positions.size());
    mesh.rest_positions.push_back(grid.world_of(index));
  }
  for_occupied(lattice, occupied, [&](std::int64_t a, std::int64_t b, std::int64_t c) {
    const auto add = [&](auto& list, const auto& corners) {
      auto& nodes = list.emplace_back();
      for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = corner_of(a, b, c, corners[n]);
    };
    if (hexahedra) {
      add(mesh.hexes, std::array{0, 1, 3, 2, 4, 5, 7, 6});
    } else {
      for (const auto& corners : tets_of_cell[(a + b + c) % 2]) add(mesh.tets, corners);
    }
  });
  return mesh;
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
  const Box box = foreground_box(volume, options);
  const Lattice lattice = place_cells(volume.grid, box, options.cells);
  const auto occupied = occupied_cells(volume, options, box, lattice);
  Mesh mesh = mesh_of_cells(volume.grid, lattice, occupied, options.hexahedra);
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
