/// @file voxel_fields.hpp
/// Stage "fields" of the warp, per voxel, after the raster: what the owner of a voxel says of the
/// deformation there.
#pragma once
#include <cstdint>

#include "kernels/hex_map.hpp"
#include "kernels/tet_gradient.hpp"
#include "kernels/tet_setup.hpp"
#include "kernels/tet_strain.hpp"
#include "kernels/view.hpp"

namespace tetwarp {

/// From a voxel and its source position, both in index space, to how far apart they are in the
/// world: offset + source (x_source - x) + apart x. Exact where nothing moves.
struct DisplacementMap {
  Matrix3 source;         ///< axes of the source [world per voxel]
  Matrix3 apart;          ///< these less those of the output grid
  double offset[3];       ///< origin of the source less that of the output grid [world]
  std::int64_t frame[3];  ///< index of frame voxel (0, 0, 0) in the output grid
};

/// Where the fields of a step go, [voxel][component]; null: not wanted.
struct VoxelFields {
  float* displacement = nullptr;  ///< 3
  float* jacobian = nullptr;      ///< 1
  float* gradient = nullptr;      ///< 9
  float* strain = nullptr;        ///< 6
};

/// Source position of a voxel [frame] that tetrahedron t owns: its map, or that of its hexahedron,
/// in float64.
TETWARP_HD void source_position(
    const HexMesh& mesh, std::int64_t t, const TetSetup& tet, const int* voxel, double* position) {
  if (tet.kind == MapKind::trilinear) {
    int whole[3];
    place_in_hex(tet, make_hex_map(mesh, t, tet), voxel, whole, position);
    for (int axis = 0; axis < 3; ++axis) position[axis] += whole[axis];
    return;
  }
  double from[3];
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = static_cast<double>(voxel[axis] - tet.anchor[axis]);
  }
  for (int row = 0; row < 3; ++row) {
    position[row] = tet.map[0][row] * from[0] + tet.map[1][row] * from[1] +
                    tet.map[2][row] * from[2] + tet.map[3][row];
  }
}

/// Rest less deformed position of what a voxel shows [world].
TETWARP_HD void set_displacement(const DisplacementMap& map,
                                 const int* voxel,
                                 const double* position,
                                 float* displacement) {
  double index[3], step[3];
  for (int axis = 0; axis < 3; ++axis) {
    index[axis] = static_cast<double>(voxel[axis] + map.frame[axis]);
    step[axis] = position[axis] - index[axis];
  }
  for (int row = 0; row < 3; ++row) {
    double sum = map.offset[row];
    for (int axis = 0; axis < 3; ++axis) {
      sum += map.source.at[row][axis] * step[axis] + map.apart.at[row][axis] * index[axis];
    }
    displacement[row] = static_cast<float>(sum);
  }
}

/// One index = a stretch of voxels of a row; any order.
struct VoxelFieldsBody {
  View<const TetSetup> setups;
  HexMesh mesh;
  GridAxes axes;
  View<const TetStrain> strains;     ///< only read for fields other than the displacement
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

  TETWARP_HD void operator()(std::int64_t index) const {
    const std::int64_t row = index / stretches_per_row();
    const int ny = frame.end[1] - frame.begin[1];
    const int first = frame.begin[0] + static_cast<int>(index % stretches_per_row()) * stretch;
    const int past = min_of(first + stretch, frame.end[0]);
    int voxel[3] = {first, frame.begin[1] + static_cast<int>(row % ny),
                    frame.begin[2] + static_cast<int>(row / ny)};
    std::int64_t at = frame.offset_of(voxel[0], voxel[1], voxel[2]);
    for (; voxel[0] < past; ++voxel[0], ++at) {
      if (touched.size == 0 || touched[cell_of_voxel(voxel)] != 0) write(voxel, at);
    }
  }

  TETWARP_HD std::int64_t cell_of_voxel(const int* voxel) const {
    return frame.cell_index(voxel[0] >> cell_shift, voxel[1] >> cell_shift, voxel[2] >> cell_shift);
  }

  TETWARP_HD void write(const int* voxel, std::int64_t at) const {
    const std::int32_t owner = owners[at];
    if (fields.displacement != nullptr) {
      float displacement[3] = {0, 0, 0};
      if (owner >= 0) {
        double position[3];
        source_position(mesh, owner, setups[owner], voxel, position);
        set_displacement(map, voxel, position, displacement);
      }
      copy(displacement, 3, fields.displacement, at);
    }
    if (fields.jacobian == nullptr && fields.gradient == nullptr && fields.strain == nullptr) {
      return;
    }
    const TetStrain strain = owner >= 0 ? strain_at(owner, voxel) : TetStrain{};
    if (fields.jacobian != nullptr) fields.jacobian[at] = strain.jacobian;
    if (fields.gradient != nullptr) copy(strain.gradient, 9, fields.gradient, at);
    if (fields.strain != nullptr) copy(strain.strain, 6, fields.strain, at);
  }

  /// That of the owner; within a hexahedron that of the voxel.
  TETWARP_HD TetStrain strain_at(std::int32_t owner, const int* voxel) const {
    if (setups[owner].kind != MapKind::trilinear) return strains[owner];
    const HexMap hex = make_hex_map(mesh, owner, setups[owner]);
    double u[3];
    Matrix3 backward;
    hex_local(hex, setups[owner], voxel, u);
    if (!hex_gradient(hex, u, backward)) return strains[owner];
    return strain_of(axes.source * backward * axes.output_index);
  }

  TETWARP_HD static void copy(const float* from, int components, float* to, std::int64_t at) {
    for (int c = 0; c < components; ++c) to[at * components + c] = from[c];
  }
};

/// Writes the wanted fields of every voxel of the cells to write; zeros where nothing covers.
///
/// @param exec  where to run
/// @param body  what to write; its stretch is chosen here: whole rows for a thread that runs
///              through memory, single voxels where neighbouring threads share it
/// @pre   `owners` holds what the raster found, also of cells that are not written
///
/// Determinism: a displacement is that of the float64 position, rounded once, to within an ulp
/// between back ends; the rest is copied. Cost: 4 bytes read and those of the fields written per
/// voxel, 60 operations for a displacement.
template <class Exec>
void voxel_fields(Exec& exec, VoxelFieldsBody body) {
  body.stretch = Exec::reads_are_free ? body.frame.end[0] - body.frame.begin[0] : 1;
  exec.for_each("warp/fields", body.index_count(), body);
}

}  // namespace tetwarp
