/// @file extension.hpp
/// Displacements outside of the mesh, for any executor.
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "host/base/index_space.hpp"
#include "host/base/warp_backend.hpp"
#include "host/warp/geometry.hpp"
#include "host/warp/outside_surface.hpp"
#include "host/warp/stages/pairs.hpp"
#include "kernels/warp/voxel_extend.hpp"

namespace tetwarp {

/// Writes the voxels that no tetrahedron covers, with Outside::nearest and Outside::falloff.
template <class Exec>
class WarpExtension {
 public:
  /// The arguments must outlive the object.
  WarpExtension(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : exec_(exec), geometry_(geometry), is_requested_(extends(plan.options.outside)) {
    if (!is_requested_) return;
    surface_ = make_outside_surface(plan.mesh);
    for (const std::int32_t node : surface_.nodes) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        rest_.push_back(plan.mesh.rest_positions[static_cast<std::size_t>(node)][axis] -
                        plan.output_grid.origin[axis]);
      }
    }
    const std::int64_t nodes = std::ssize(surface_.nodes);
    SurfaceTree& tree = extension_.tree;
    tree.triangles = exec.resident("warp/upload", surface_.triangles.front().data(),
                                   3 * std::ssize(surface_.triangles), triangle_buffer_);
    numbers_ = exec.resident("warp/upload", surface_.nodes.data(), nodes, number_buffer_);
    rest_view_ = exec.resident("warp/upload", rest_.data(), 3 * nodes, rest_buffer_);
    node_buffer_.reserve(nodes);
    box_buffer_.reserve(2 * surface_.leaves);
    tree.nodes = node_buffer_.const_view(nodes);
    tree.boxes = box_buffer_.const_view(2 * surface_.leaves);
    const IndexFromWorld from_world = index_from_world(plan.sources.front().grid);
    const Grid& output = plan.output_grid;
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        extension_.to_world[row][axis] = output.direction[3 * row + axis] * output.spacing[axis];
        extension_.from_world[row][axis] = from_world.linear[row][axis];
      }
    }
    extension_.reach = plan.options.outside == Outside::falloff
                           ? plan.options.falloff
                           : std::numeric_limits<double>::infinity();
  }

  bool is_requested() const { return is_requested_; }

  /// Finds the surface of a step, after its pairs.
  void run(const WarpPairs<Exec>& pairs) {
    SurfaceNodeOp body{
        pairs.nodes(), numbers_, rest_view_, {}, {}, node_buffer_.view(std::ssize(surface_.nodes))};
    for (int row = 0; row < 3; ++row) {
      body.frame[row] = geometry_.frame.origin[row];
      for (int axis = 0; axis < 3; ++axis) {
        body.to_world[row][axis] = extension_.to_world[row][axis];
      }
    }
    exec_.for_each("warp/fields", std::ssize(surface_.nodes), body);
    const View<SurfaceBox> boxes = box_buffer_.view(2 * surface_.leaves);
    for (std::int64_t first = surface_.leaves; first > 0; first /= 2) {
      exec_.for_each("warp/fields", first, SurfaceBoxOp{extension_.tree, boxes, first});
    }
  }

  /// Writes a source's samples.
  /// @param job           as of the raster
  /// @param owners        tetrahedron of each output voxel, -1 outside
  /// @param displacement  in the memory of the executor; null: not written
  template <class T>
  void write(const RasterJob<T>& job, View<const std::int32_t> owners, float* displacement) {
    voxel_extend(exec_, VoxelExtendOp<T>{job, owners, extension_, displacement});
  }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  Exec& exec_;
  const WarpGeometry& geometry_;
  bool is_requested_;
  OutsideSurface surface_;
  std::vector<double> rest_;  ///< from the output's first voxel [world]
  Buffer<std::int32_t> triangle_buffer_, number_buffer_;
  Buffer<double> rest_buffer_;
  Buffer<SurfaceNode> node_buffer_;
  Buffer<SurfaceBox> box_buffer_;
  View<const std::int32_t> numbers_;
  View<const double> rest_view_;
  Extension extension_{};
};

}  // namespace tetwarp
