/// @file geometry.cpp
/// Makes the frame, quantizes the mesh and checks its size.
#include "host/warp/geometry.hpp"

#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>

#include "host/base/index_space.hpp"
#include "kernels/base/hex_view.hpp"
#include "kernels/warp/face_sign.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {
namespace {
OutputFrame make_frame(const Region& region) {
  OutputFrame frame;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    frame.origin[axis] = region.begin[axis] / cell_edge * cell_edge;
    frame.begin[axis] = static_cast<int>(region.begin[axis] - frame.origin[axis]);
    frame.end[axis] = static_cast<int>(region.end[axis] - frame.origin[axis]);
    frame.cells[axis] = (frame.end[axis] + cell_edge - 1) / cell_edge;
  }
  return frame;
}

OutsideMap make_outside_map(const WarpPlan& plan, const OutputFrame& frame) {
  OutsideMap outside = {};
  if (plan.options.outside == Outside::background) return outside;
  const IndexMap map = source_from_output(plan.sources.front().grid, plan.output_grid);
  outside.use_source = plan.options.outside == Outside::identity;
  outside.is_copy = map.linear == std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (std::size_t row = 0; row < 3; ++row) {
    outside.offset[row] = map.offset[row];
    outside.origin[row] = static_cast<double>(frame.origin[row]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      outside.linear[row][axis] = map.linear[3 * row + axis];
    }
  }
  return outside;
}

Matrix3 linear_part(const IndexFromWorld& map) {
  Matrix3 matrix;
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) matrix.at[row][axis] = map.linear[row][axis];
  }
  return matrix;
}

GridAxes make_axes(const Grid& source, const Grid& output) {
  GridAxes axes;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      axes.source.at[row][axis] = source.direction[3 * row + axis] * source.spacing[axis];
    }
  }
  axes.output_index = linear_part(index_from_world(output));
  axes.are_same = source.spacing == output.spacing && source.direction == output.direction;
  return axes;
}

bool is_too_large(const TetNodes& tet) {
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t low = tet.x[0][axis], high = low;
    for (int a = 1; a < 4; ++a) {
      low = min_of(low, tet.x[a][axis]);
      high = max_of(high, tet.x[a][axis]);
    }
    if (high - low > longest_extent) return true;
  }
  return false;
}

/// Kind and number of the cell that tetrahedron t is or is a part of, for messages.
std::string cell_name(const Mesh& mesh, std::size_t t) {
  const std::size_t alone = mesh.tets.size() - tets_per_hex * mesh.hexes.size();
  if (t < alone) return "tetrahedron " + std::to_string(t);
  return "hexahedron " + std::to_string((t - alone) / tets_per_hex);
}
}  // namespace

WarpGeometry make_geometry(const WarpPlan& plan) {
  WarpGeometry geometry;
  geometry.frame = make_frame(plan.region);
  geometry.output_index = index_from_world(plan.output_grid);
  geometry.outside = make_outside_map(plan, geometry.frame);

  geometry.axes = make_axes(plan.sources.front().grid, plan.output_grid);

  const IndexFromWorld source_index = index_from_world(plan.sources.front().grid);
  const std::int64_t no_shift[3] = {0, 0, 0};
  for (std::size_t n = 0; n < plan.mesh.rest_positions.size(); ++n) {
    geometry.rest.push_back(quantized(source_index, plan.mesh.rest_positions[n].data(), no_shift));
    if (geometry.rest.back().x[0] == bad_node) {
      throw std::invalid_argument("mesh: rest position of node " + std::to_string(n) +
                                  " is over 2^40 voxels from the source grid");
    }
  }
  // In index spaces of opposite handedness the same tetrahedron has volumes of opposite sign.
  const bool mirrored =
      determinant(linear_part(source_index)) * determinant(geometry.axes.output_index) < 0;
  const View<const Node> rest{geometry.rest.data(),
                              static_cast<std::int64_t>(geometry.rest.size())};
  for (std::size_t t = 0; t < plan.mesh.tets.size(); ++t) {
    const TetNodes tet = tet_nodes(rest, plan.mesh.tets[t].data());
    if (is_too_large(tet)) {
      throw std::invalid_argument("mesh: " + cell_name(plan.mesh, t) +
                                  " spans over 2^20 voxels of the source at rest");
    }
    geometry.rest_orientation.push_back(
        static_cast<std::int8_t>(mirrored ? -orientation(tet) : orientation(tet)));
  }
  return geometry;
}

void ProgressPart::report(double fraction) const {
  if (progress && !progress(begin + share * fraction)) throw Cancelled();
}

}  // namespace tetwarp
