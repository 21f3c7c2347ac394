/// @file curves.hpp
/// Curved maps of tetrahedra of ten nodes, for any executor.
#pragma once
#include <cstdint>

#include "host/base/warp_backend.hpp"
#include "host/warp/geometry.hpp"
#include "host/warp/stages/fields.hpp"
#include "host/warp/stages/pairs.hpp"
#include "host/warp/target.hpp"
#include "kernels/warp/voxel_curve.hpp"

namespace tetwarp {

/// Writes the voxels of tetrahedra of ten nodes, where the mesh has any.
template <class Exec>
class WarpCurves {
 public:
  /// The arguments must outlive the object.
  WarpCurves(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : exec_(exec), plan_(plan), geometry_(geometry) {
    if (plan.mid_nodes.empty()) return;
    view_.nodes = exec.resident("warp/upload", plan.mid_nodes.front().data(),
                                6 * static_cast<std::int64_t>(plan.mid_nodes.size()), buffer_);
  }

  bool are_there() const { return view_.nodes.size > 0; }

  /// Writes the samples of a source.
  /// @param job     as of the raster
  /// @param owners  tetrahedron of each output voxel, -1 outside
  /// @param count   voxels whose curved map has no inverse, added; null: not counted
  template <class T>
  void write(const WarpPairs<Exec>& pairs,
             const RasterJob<T>& job,
             View<const std::int32_t> owners,
             std::int64_t* count) {
    voxel_curve(exec_, "warp/raster", VoxelCurveOp<T>{voxels(pairs, owners), job, count});
  }

  /// Writes the fields that depend on owners.
  void write(const WarpPairs<Exec>& pairs, View<const std::int32_t> owners, const FieldTarget& to) {
    if (!needs_owners(to)) return;
    voxel_curve(exec_, "warp/fields",
                CurveFieldsOp{voxels(pairs, owners),
                              geometry_.axes,
                              make_displacement_map(plan_, geometry_.frame),
                              {to.displacement, to.jacobian, to.gradient, to.strain}});
  }

 private:
  CurveVoxels voxels(const WarpPairs<Exec>& pairs, View<const std::int32_t> owners) const {
    return {{view_, pairs.tets(), pairs.nodes(), pairs.rest(), pairs.setups()},
            owners,
            geometry_.frame,
            1};
  }

  Exec& exec_;
  const WarpPlan& plan_;
  const WarpGeometry& geometry_;
  typename Exec::template Buffer<std::int32_t> buffer_;
  CurveView view_;
};

}  // namespace tetwarp
