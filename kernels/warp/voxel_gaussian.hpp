/// @file voxel_gaussian.hpp
/// Stage "raster" of labels by Gaussian weights, after the owners of voxels are found.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/hex_map.hpp"
#include "kernels/warp/row_resample.hpp"
#include "kernels/warp/sample/gaussian_label.hpp"
#include "kernels/warp/surface_tree.hpp"
#include "kernels/warp/voxel_fields.hpp"

namespace tetwarp {

/// One index = one voxel of the output; any order.
struct VoxelGaussianOp {
  View<const TetSetup> setups;
  HexMesh mesh;
  View<const std::int32_t> owners;   ///< -1: none
  View<const std::uint8_t> touched;  ///< cells to write; size 0: all
  OutputFrame frame;
  OutsideMap outside;
  GaussianLabels labels;
  NumberView output;

  TETWARP_HD void operator()(std::int64_t at) const {
    int voxel[3];
    frame.set_voxel(at, voxel);
    if (touched.size > 0 && touched[frame.cell_of_voxel(voxel)] == 0) return;
    double x[3];
    if (owners[at] >= 0) {
      set_position(owners[at], voxel, x);
    } else if (outside.use_source) {
      double index[3];
      for (int axis = 0; axis < 3; ++axis) index[axis] = outside.origin[axis] + voxel[axis];
      for (int row = 0; row < 3; ++row) {
        x[row] = dot_product(outside.linear[row], index) + outside.offset[row];
      }
    } else {
      output.set(at, labels.background);
      return;
    }
    output.set(at, labels.at(x));
  }

 private:
  TETWARP_HD void set_position(std::int32_t owner, const int* voxel, double* x) const {
    if (!mesh.hexes.has(owner) || setups[owner].kind != MapKind::trilinear) {
      source_position(setups[owner], voxel, x);
      return;
    }
    int whole[3];
    hex_source_position(make_hex_map(mesh, owner, setups[owner]), voxel, whole, x);
    for (int axis = 0; axis < 3; ++axis) x[axis] += whole[axis];
  }
};

/// Sets voxels to the label that a Gaussian around their source position weighs most.
/// @param exec  where to run
/// @param op    input and output
///
/// Determinism: the same labels on every back end, but where sums of weights differ by 2^-40 of the
/// whole to within the rounding of erf(). Cost: for a window of one label a read of its voxels,
/// else up to 12 erf() and an addition per voxel of the window. Source: the weights and their
/// window are those of ITK's LabelImageGaussianInterpolateImageFunction.
template <class Exec>
void voxel_gaussian(Exec& exec, const VoxelGaussianOp& op) {
  exec.for_each("warp/raster", op.frame.voxel_count(), op);
}

/// One index = one row of the output of resample(); any order. Positions are those of
/// RowResampleOp.
struct RowGaussianOp {
  GaussianLabels labels;
  ResampleMap map;
  std::int64_t dims[3];   ///< of the output, or of a part of it of whole rows
  std::int64_t begin[2];  ///< first row and slice of the part in the output
  NumberView output;

  TETWARP_HD void operator()(std::int64_t row) const {
    const std::int64_t j = begin[0] + row % dims[1], k = begin[1] + row / dims[1];
    for (std::int64_t i = 0; i < dims[0]; ++i) {
      double x[3];
      const bool is_near = map.position(i, j, k, x);
      output.set(row * dims[0] + i, is_near ? labels.at(x) : labels.background);
    }
  }
};

}  // namespace tetwarp
