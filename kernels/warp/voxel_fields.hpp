/// @file voxel_fields.hpp
/// Stage "fields" of the warp, per voxel, after the raster: displacement, Jacobian determinant,
/// gradient and strain at each voxel, from its owner.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/warp/hex_map.hpp"
#include "kernels/warp/tet_gradient.hpp"
#include "kernels/warp/tet_setup.hpp"
#include "kernels/warp/tet_strain.hpp"

namespace tetwarp {

/// World displacement of a voxel x with source position x_source, both in index space: offset +
/// source (x_source - x) + apart x. Exact where nothing moves.
struct DisplacementMap {
  Matrix3 source;         ///< axes of the source [world per voxel]
  Matrix3 apart;          ///< axes of the source minus those of the output grid
  double offset[3];       ///< origin of the source minus that of the output grid [world]
  std::int64_t frame[3];  ///< index of frame voxel (0, 0, 0) in the output grid
};

/// Output arrays of fields, [voxel][component]; null: not written.
struct VoxelFields {
  float* displacement = nullptr;  ///< 3
  float* jacobian = nullptr;      ///< 1
  float* gradient = nullptr;      ///< 9
  float* strain = nullptr;        ///< 6
};

/// Source position of a voxel [frame] under a tetrahedron's map, in float64. For voxels of
/// hexahedra see hex_source_position().
TETWARP_HD void source_position(const TetSetup& tet, const int* voxel, double* position) {
  double from[3];
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = static_cast<double>(voxel[axis] - tet.anchor[axis]);
  }
  for (int row = 0; row < 3; ++row) {
    position[row] = tet.map[0][row] * from[0] + tet.map[1][row] * from[1] +
                    tet.map[2][row] * from[2] + tet.map[3][row];
  }
}

/// Displacement at a voxel: rest minus deformed position [world].
/// @param position  source position of the voxel
TETWARP_HD void displacement_of(const DisplacementMap& map,
                                const int* voxel,
                                const double* position,
                                double* displacement) {
  double index[3], step[3];
  for (int axis = 0; axis < 3; ++axis) {
    index[axis] = static_cast<double>(voxel[axis] + map.frame[axis]);
    step[axis] = position[axis] - index[axis];
  }
  for (int row = 0; row < 3; ++row) {
    displacement[row] = map.offset[row];
    for (int axis = 0; axis < 3; ++axis) {
      displacement[row] +=
          map.source.at[row][axis] * step[axis] + map.apart.at[row][axis] * index[axis];
    }
  }
}

/// Strain at a voxel of a hexahedron. Out of line to limit registers.
/// @param strain  in: strain of the owning tetrahedron, kept where the trilinear map is singular
TETWARP_HD_RARE void set_hex_strain(const HexMap& hex,
                                    const GridAxes& axes,
                                    const int* voxel,
                                    TetStrain& strain) {
  double u[3];
  Matrix3 backward;
  hex_local(hex, voxel, u);
  if (hex_gradient(hex, u, backward)) {
    strain = strain_of(axes.source * backward * axes.output_index);
  }
}

/// Displacements along a row of voxels of one tetrahedron: base + (i - first) step. `first` is the
/// tetrahedron's anchor, so the result does not depend on which voxels of the row are computed.
struct RowDisplacement {
  double base[3];
  double step[3];
  std::int64_t first;
};

/// @param voxel  any voxel of the row [frame]
TETWARP_HD RowDisplacement row_displacement(const DisplacementMap& map,
                                            const TetSetup& tet,
                                            const int* voxel) {
  RowDisplacement row;
  row.first = tet.anchor[0];
  const int start[3] = {static_cast<int>(row.first), voxel[1], voxel[2]};
  double position[3];
  source_position(tet, start, position);
  displacement_of(map, start, position, row.base);
  for (int r = 0; r < 3; ++r) {
    row.step[r] = map.apart.at[r][0];
    for (int axis = 0; axis < 3; ++axis) {
      const double self = axis == 0 ? 1 : 0;
      row.step[r] += map.source.at[r][axis] * (tet.map[0][axis] - self);
    }
  }
  return row;
}

/// Input and output of the bodies below.
struct VoxelFieldsJob {
  View<const TetSetup> setups;
  HexMesh mesh;
  GridAxes axes;
  View<const TetStrain> strains;     ///< size 0: only the displacement is written
  View<const std::int32_t> owners;   ///< -1: none
  View<const std::uint8_t> touched;  ///< cells to write; size 0: all
  OutputFrame frame;
  DisplacementMap map;
  VoxelFields fields;
  int stretch;  ///< voxels per index

  TETWARP_HD std::int64_t stretches_per_row() const {
    return (frame.end[0] - frame.begin[0] + stretch - 1) / stretch;
  }
  TETWARP_HD std::int64_t index_count() const {
    return stretches_per_row() * (frame.end[1] - frame.begin[1]) * (frame.end[2] - frame.begin[2]);
  }

  /// Writes one stretch: its voxels in hexahedra, or all others.
  template <bool in_hexes>
  TETWARP_HD void write_stretch(std::int64_t index) const {
    int voxel[3];
    frame.set_row_start(index / stretches_per_row(), voxel);
    voxel[0] += static_cast<int>(index % stretches_per_row()) * stretch;
    const int past = min_of(voxel[0] + stretch, frame.end[0]);
    std::int64_t at = frame.offset_of(voxel[0], voxel[1], voxel[2]);
    while (voxel[0] < past) {
      const int count = run_length(voxel[0], past, at);
      if (is_in_hex(owners[at]) == in_hexes &&
          (touched.size == 0 || touched[frame.cell_of_voxel(voxel)] != 0)) {
        if constexpr (in_hexes) {
          write_in_hex(owners[at], voxel, at, count);
        } else {
          write(owners[at], voxel, at, count);
        }
      }
      voxel[0] += count;
      at += count;
    }
  }

  /// Number of voxels from i on with the same owner; if only touched cells are written, they end
  /// with the cell.
  TETWARP_HD int run_length(int i, int past, std::int64_t at) const {
    const int limit = touched.size == 0 ? past : min_of(past, (i | (cell_edge - 1)) + 1);
    int count = 1;
    while (i + count < limit && owners[at + count] == owners[at]) ++count;
    return count;
  }

  TETWARP_HD bool is_in_hex(std::int32_t owner) const {
    return mesh.hexes.has(owner) && setups[owner].kind == MapKind::trilinear;
  }

  TETWARP_HD void write(std::int32_t owner, const int* voxel, std::int64_t at, int count) const {
    if (owner < 0) {
      const float zeros[9] = {};
      repeat<3>(zeros, fields.displacement, at, count);
      repeat<1>(zeros, fields.jacobian, at, count);
      repeat<9>(zeros, fields.gradient, at, count);
      repeat<6>(zeros, fields.strain, at, count);
      return;
    }
    if (fields.displacement != nullptr) {
      const RowDisplacement row = row_displacement(map, setups[owner], voxel);
      float* const out = fields.displacement + 3 * at;
      for (int v = 0; v < count; ++v) {
        const double along = static_cast<double>(voxel[0] + v - row.first);
        for (int r = 0; r < 3; ++r) {
          out[3 * v + r] = static_cast<float>(row.base[r] + along * row.step[r]);
        }
      }
    }
    if (strains.size > 0) repeat(strains[owner], at, count);
  }

  /// As write() for voxels of a hexahedron, in which the gradient is not constant.
  TETWARP_HD void write_in_hex(std::int32_t owner,
                               const int* first,
                               std::int64_t at,
                               int count) const {
    const HexMap hex = make_hex_map(mesh, owner, setups[owner]);
    int voxel[3] = {first[0], first[1], first[2]};
    for (int v = 0; v < count; ++v, ++voxel[0]) {
      if (fields.displacement != nullptr) {
        int whole[3];
        double position[3], displacement[3];
        hex_source_position(hex, voxel, whole, position);
        for (int axis = 0; axis < 3; ++axis) position[axis] += whole[axis];
        displacement_of(map, voxel, position, displacement);
        for (int r = 0; r < 3; ++r) {
          fields.displacement[3 * (at + v) + r] = static_cast<float>(displacement[r]);
        }
      }
      if (strains.size == 0) continue;
      TetStrain strain = strains[owner];
      set_hex_strain(hex, axes, voxel, strain);
      repeat(strain, at + v, 1);
    }
  }

  TETWARP_HD void repeat(const TetStrain& strain, std::int64_t at, int count) const {
    repeat<1>(&strain.jacobian, fields.jacobian, at, count);
    repeat<9>(strain.gradient, fields.gradient, at, count);
    repeat<6>(strain.strain, fields.strain, at, count);
  }

  template <int components>
  TETWARP_HD static void repeat(const float* from, float* to, std::int64_t at, int count) {
    if (to == nullptr) return;
    for (std::int64_t v = at; v < at + count; ++v) {
      for (int c = 0; c < components; ++c) to[v * components + c] = from[c];
    }
  }
};

/// One index = a stretch of voxels of a row; any order.
struct VoxelFieldsOp {
  VoxelFieldsJob job;
  TETWARP_HD void operator()(std::int64_t index) const { job.write_stretch<false>(index); }
};

/// The same for voxels in hexahedra. A separate kernel, because it needs many registers.
struct HexFieldsOp {
  VoxelFieldsJob job;
  TETWARP_HD void operator()(std::int64_t index) const { job.write_stretch<true>(index); }
};

/// Writes the fields at every voxel of the touched cells; zeros at uncovered voxels.
///
/// @param exec  where to run
/// @param job   input and output; `stretch` is set here: whole rows on the CPU, single voxels on a
///              device, where adjacent threads then access adjacent memory
/// @pre   job.owners has the owners of all voxels, also in cells that are not written
///
/// Determinism: a displacement is computed in float64 and rounded once, to within an ulp between
/// back ends; the rest is copied. Cost: 4 bytes read and those of the fields written per voxel; 80
/// operations per run of voxels with one owner, and 6 more per voxel, for displacements.
/// Source: ours.
template <class Exec>
void voxel_fields(Exec& exec, VoxelFieldsJob job) {
  job.stretch = Exec::reads_are_free ? job.frame.end[0] - job.frame.begin[0] : 1;
  exec.for_each("warp/fields", job.index_count(), VoxelFieldsOp{job});
  if (job.mesh.hexes.nodes.size > 0) {
    exec.for_each("warp/fields", job.index_count(), HexFieldsOp{job});
  }
}

}  // namespace tetwarp
