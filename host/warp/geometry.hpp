/// @file geometry.hpp
/// A plan in index space: the frame of the output, the quantized rest mesh, the map of uncovered
/// voxels.
#pragma once
#include <cstdint>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/tet_gradient.hpp"

namespace tetwarp {

/// Geometry that is the same in all steps, in the types of the kernels.
struct WarpGeometry {
  OutputFrame frame;
  IndexFromWorld output_index;
  std::vector<Node> rest;                     ///< in the source's index space [quantum]
  std::vector<std::int8_t> rest_orientation;  ///< sign of the rest volume as it would be in the
                                              ///< output's index space
  OutsideMap outside;
  GridAxes axes;
};

/// @throws std::invalid_argument when a rest position is too far from the source grid, or a
///                               tetrahedron spans too many of its voxels
WarpGeometry make_geometry(const WarpPlan& plan);

/// A part of a step that reports its progress.
struct ProgressPart {
  const Progress& progress;
  double begin;  ///< fraction of the step that is finished before this part
  double share;  ///< of this part in the step

  /// Reports that `fraction` of this part is finished.
  /// @throws Cancelled when the callback returns false
  void report(double fraction) const;
  bool is_requested() const { return static_cast<bool>(progress); }
};

/// Samples of a source in the form that kernels read.
/// @param held  voxels of the source grid that `data` holds
/// @param data  in the kernel's memory
template <class T>
SourceView<T> source_view(const Region& held, int components, const void* data) {
  SourceView<T> view;
  view.data = static_cast<const T*>(data);
  view.components = components;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    view.origin[axis] = static_cast<int>(held.begin[axis]);
    view.dims[axis] = static_cast<int>(held.end[axis] - held.begin[axis]);
  }
  return view;
}

}  // namespace tetwarp
