/// @file fields.hpp
/// The stages that write FieldTarget, for any executor.
#pragma once
#include <cstdint>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "host/warp/geometry.hpp"
#include "host/warp/stages/pairs.hpp"
#include "host/warp/target.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/tet_strain.hpp"
#include "kernels/warp/voxel_fields.hpp"

namespace tetwarp {

/// The constants of voxel_fields(): index spaces of output grid and source, and their difference.
inline DisplacementMap make_displacement_map(const WarpPlan& plan, const OutputFrame& frame) {
  const Grid &source = plan.sources.front().grid, &output = plan.output_grid;
  DisplacementMap map;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t entry = 3 * row + axis;
      map.source.at[row][axis] = source.direction[entry] * source.spacing[axis];
      map.apart.at[row][axis] =
          map.source.at[row][axis] - output.direction[entry] * output.spacing[axis];
    }
    map.offset[row] = source.origin[row] - output.origin[row];
    map.frame[row] = frame.origin[row];
  }
  return map;
}

/// Computes the fields of each step.
template <class Exec>
class WarpFields {
 public:
  /// The arguments must outlive it.
  WarpFields(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : exec_(exec), plan_(plan), geometry_(geometry) {}

  /// Writes the fields of a step after its raster.
  /// @param owners   tetrahedron of each output voxel, -1 outside; size 0: no field uses them
  /// @param touched  1 for cells to write, see WarpPairs::touched_in(); size 0: all
  /// @param to       arrays in the memory of the executor; null: not written
  void run(const WarpPairs<Exec>& pairs,
           View<const std::int32_t> owners,
           View<const std::uint8_t> touched,
           const FieldTarget& to) {
    if (needs_owners(to)) {
      const bool strained =
          to.jacobian != nullptr || to.gradient != nullptr || to.strain != nullptr;
      strains_.reserve(strained ? pairs.tet_count() : 0);
      const View<TetStrain> strains = strains_.view(strained ? pairs.tet_count() : 0);
      if (strained) tet_strain(exec_, pairs.setups(), geometry_.axes, strains);
      voxel_fields(exec_, {.setups = pairs.setups(),
                           .mesh = {pairs.hexes(), pairs.tets(), pairs.nodes(), pairs.rest()},
                           .axes = geometry_.axes,
                           .strains = strains,
                           .owners = owners,
                           .touched = touched,
                           .frame = geometry_.frame,
                           .map = make_displacement_map(plan_, geometry_.frame),
                           .fields = {to.displacement, to.jacobian, to.gradient, to.strain},
                           .stretch = 1});
    }
    if (to.forward != nullptr) forward(pairs, to.forward);
  }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  /// The forward field: the backward displacement of the warp with rest and deformed positions
  /// exchanged. Its owners are those of the rest mesh, computed once. Both meshes are relative to
  /// the frame, so that its origin cancels.
  void forward(const WarpPairs<Exec>& pairs, float* to) {
    const OutputFrame& frame = geometry_.frame;
    const std::int64_t tets = pairs.tet_count();
    if (!has_rest_) find_rest();
    exchanged_.reserve(tets);
    unused_.reserve(tets + 1 + tet_class_count);
    const View<std::int64_t> unused = unused_.view(tets + 1 + tet_class_count);
    exec_.zero("warp/fields", unused);
    tet_setup(exec_, {.tets = pairs.tets(),
                      .deformed = rest_.const_view(pairs.rest().size),
                      .rest = pairs.nodes(),
                      .rest_orientation = pairs.rest_orientation(),
                      .frame = frame,
                      .setups = exchanged_.view(tets),
                      .pair_counts = {unused.data, tets + 1},
                      .class_counts = {unused.data + tets + 1, tet_class_count},
                      .hexes = pairs.hexes()});
    DisplacementMap map = make_displacement_map(plan_, frame);
    for (std::int64_t& shift : map.frame) shift = 0;
    const View<const Node> rest = rest_.const_view(pairs.rest().size);
    voxel_fields(exec_, {.setups = exchanged_.const_view(tets),
                         .mesh = {pairs.hexes(), pairs.tets(), rest, pairs.nodes()},
                         .axes = geometry_.axes,
                         .strains = {},
                         .owners = rest_owners_.const_view(frame.voxel_count()),
                         .touched = {},
                         .frame = frame,
                         .map = map,
                         .fields = {.displacement = to},
                         .stretch = 1});
  }

  /// Computes the rest mesh in the frame and the owners of its voxels, by a raster of the mesh at
  /// rest whose samples are discarded.
  void find_rest() {
    const std::vector<Point3>& positions = plan_.mesh.rest_positions;
    const OutputFrame& frame = geometry_.frame;
    const auto nodes = static_cast<std::int64_t>(positions.size());
    Buffer<double> position_buffer;
    const View<const double> rest =
        exec_.resident("warp/upload", positions.front().data(), 3 * nodes, position_buffer);
    rest_.reserve(nodes);
    node_quantize(exec_, geometry_.output_index, frame.origin, rest, rest_.view(nodes));

    WarpPairs<Exec> pairs(exec_, plan_, geometry_);
    pairs.run(rest);
    Buffer<std::uint8_t> samples;
    samples.reserve(frame.voxel_count());
    rest_owners_.reserve(frame.voxel_count());
    exec_.zero("warp/fields", samples.view(1));
    RasterJob<std::uint8_t> job{};
    job.setups = pairs.setups();
    job.tets = pairs.tets();
    job.nodes = pairs.nodes();
    job.pairs = pairs.list().pairs;
    job.ranges = {pairs.list().ranges.data, frame.cell_count()};
    job.frame = frame;
    job.source = source_view<std::uint8_t>(Region{{0, 0, 0}, {1, 1, 1}}, 1, samples.view(1).data);
    job.filter = Filter::nearest;
    job.volume = samples.view(frame.voxel_count()).data;
    job.tet = rest_owners_.view(frame.voxel_count()).data;
    const Progress silent;
    cell_raster(exec_, job, ProgressPart{silent, 0, 1});
    std::int32_t first;
    exec_.get(rest_owners_.const_view(1),
              &first);  // waits until the scratch memory is no longer in use
    has_rest_ = true;
  }

  Exec& exec_;
  const WarpPlan& plan_;
  const WarpGeometry& geometry_;
  Buffer<TetStrain> strains_;
  Buffer<Node> rest_;  ///< in the frame
  Buffer<std::int32_t> rest_owners_;
  Buffer<TetSetup> exchanged_;   ///< from rest to deformed
  Buffer<std::int64_t> unused_;  ///< counts of tet_setup() that the forward field does not need
  bool has_rest_ = false;
};

}  // namespace tetwarp
