/// @file voxel_curve.hpp
/// Stage "curve" of the warp, after the raster and the fields: voxels of tetrahedra of ten nodes,
/// which the raster has mapped by the four corners, are written again by the quadratic map. It runs
/// only for meshes that have such tetrahedra.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/curve_map.hpp"
#include "kernels/warp/tet_strain.hpp"
#include "kernels/warp/voxel_fields.hpp"

namespace tetwarp {

/// The voxels of a step and the maps of their owners, visited in stretches of rows.
struct CurveVoxels {
  CurveMesh mesh;
  View<const std::int32_t> owners;  ///< -1: none
  OutputFrame frame;
  int stretch;  ///< voxels per index

  TETWARP_HD std::int64_t stretches_per_row() const {
    return (frame.end[0] - frame.begin[0] + stretch - 1) / stretch;
  }
  TETWARP_HD std::int64_t index_count() const {
    return stretches_per_row() * (frame.end[1] - frame.begin[1]) * (frame.end[2] - frame.begin[2]);
  }

  /// Calls write(map, u, voxel, at) for the voxels of a stretch that have a curved map.
  /// @returns the number of those whose curved map has no inverse
  template <class Write>
  TETWARP_HD std::int64_t visit(std::int64_t index, const Write& write) const {
    int voxel[3];
    frame.set_row_start(index / stretches_per_row(), voxel);
    voxel[0] += static_cast<int>(index % stretches_per_row()) * stretch;
    const int past = min_of(voxel[0] + stretch, frame.end[0]);
    std::int32_t mapped = -1;
    CurveKind kind = CurveKind::straight;
    CurveMap map;
    std::int64_t lost = 0;
    for (std::int64_t at = frame.offset_of(voxel[0], voxel[1], voxel[2]); voxel[0] < past;
         ++voxel[0], ++at) {
      const std::int32_t owner = owners[at];
      if (owner < 0) continue;
      if (owner != mapped) kind = make_curve_map(mesh, owner, map);
      mapped = owner;
      if (kind == CurveKind::straight) continue;
      double u[3];
      if (kind == CurveKind::curved && curve_local(map, mesh.setups[owner], voxel, u)) {
        write(map, u, voxel, at);
      } else {
        ++lost;
      }
    }
    return lost;
  }
};

/// Samples of one source. One index = a stretch of voxels of a row; any order.
template <class T>
struct VoxelCurveOp {
  CurveVoxels voxels;
  RasterJob<T> job;     ///< source, filter, background and volume are used
  std::int64_t* count;  ///< voxels without an inverse are added to it; null: not counted

  TETWARP_HD void operator()(std::int64_t index) const {
    const RasterJob<T>& to = job;
    const std::int64_t lost = voxels.visit(
        index, [&to](const CurveMap& map, const double* u, const int*, std::int64_t at) {
          int whole[3];
          double x[3];
          ArithmeticOf<T> local[3];
          curve_source_position(map, u, whole, x);
          for (int axis = 0; axis < 3; ++axis) {
            whole[axis] -= to.source.origin[axis];
            local[axis] = static_cast<ArithmeticOf<T>>(x[axis]);
          }
          store_position<true>(to, to.filter, whole, local, at);
        });
    if (count != nullptr && lost > 0) atomic_add(count, lost);
  }
};

/// Fields of the deformation. One index = a stretch of voxels of a row; any order.
struct CurveFieldsOp {
  CurveVoxels voxels;
  GridAxes axes;
  DisplacementMap map;
  VoxelFields fields;

  TETWARP_HD void operator()(std::int64_t index) const {
    const CurveFieldsOp& to = *this;
    voxels.visit(index, [&to](const CurveMap& curve, const double* u, const int* voxel,
                              std::int64_t at) { to.write(curve, u, voxel, at); });
  }

 private:
  TETWARP_HD void write(const CurveMap& curve,
                        const double* u,
                        const int* voxel,
                        std::int64_t at) const {
    double position[3], x[3];
    Matrix3 output, source;
    map_curve(curve.source, u, position, source);
    map_curve(curve.output, u, x, output);
    if (fields.displacement != nullptr) {
      double displacement[3];
      for (int axis = 0; axis < 3; ++axis) {
        position[axis] += static_cast<double>(curve.whole[axis]);
      }
      displacement_of(map, voxel, position, displacement);
      for (int r = 0; r < 3; ++r) {
        fields.displacement[3 * at + r] = static_cast<float>(displacement[r]);
      }
    }
    if (fields.jacobian == nullptr && fields.gradient == nullptr && fields.strain == nullptr)
      return;
    const TetStrain strain =
        strain_of(axes.source * (source * inverse(output)) * axes.output_index);
    if (fields.jacobian != nullptr) fields.jacobian[at] = strain.jacobian;
    for (int c = 0; c < 9 && fields.gradient != nullptr; ++c) {
      fields.gradient[9 * at + c] = strain.gradient[c];
    }
    for (int c = 0; c < 6 && fields.strain != nullptr; ++c) {
      fields.strain[6 * at + c] = strain.strain[c];
    }
  }
};

/// Runs one of these over all voxels.
/// @param exec  where to run
/// @param name  of the timing
/// @param op    input and output; `stretch` is set here: whole rows on the CPU, where the map of
///              the voxel before is kept, single voxels on a device
///
/// Determinism: positions within 2^-24 voxel of the source between back ends where the cell is not
/// nearly folded; whether a place counts as beyond the inverse may differ within that. Any region
/// has the bits of the whole grid. Cost: three Newton steps of about 200 operations a voxel, for
/// each source and for the fields; on a device 480 bytes of nodes, too. Source: the quadratic
/// tetrahedron of finite elements; ours.
template <class Exec, class Op>
void voxel_curve(Exec& exec, const char* name, Op op) {
  CurveVoxels& voxels = op.voxels;
  voxels.stretch = Exec::reads_are_free ? voxels.frame.end[0] - voxels.frame.begin[0] : 1;
  exec.for_each(name, voxels.index_count(), op);
}

}  // namespace tetwarp
