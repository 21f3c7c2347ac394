/// @file blocks.hpp
/// A warp in blocks, for volumes larger than memory and for several machines: each block of the
/// output needs a window of the source and a part of the mesh. Together the blocks have the bits of
/// the whole.
///
/// Of each block make a Warper with `options.region` = block.output, sources whose
/// VolumeView::window is block.source, and the mesh that block_mesh() cuts out.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/volume.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp {

/// What a block may hold, and how large a voxel is [byte].
struct BlockLimits {
  /// Source and output twice, for one of each is read or written meanwhile.
  double host = std::numeric_limits<double>::infinity();
  /// Source and output once.
  double device = std::numeric_limits<double>::infinity();
  double source_voxel = 4;   ///< of all sources together
  double output_voxel = 4;   ///< of all outputs together
  double scratch_voxel = 0;  ///< that a back end needs beside an output voxel
  /// Blocks are cut at multiples of it, from the region's begin on [voxel].
  std::array<std::int64_t, 3> step{8, 8, 8};
  /// Of the output; larger blocks are cut as long as steps allow.
  std::int64_t max_voxels = std::numeric_limits<std::int64_t>::max();
};

/// A part of the output and all that it depends on.
struct WarpBlock {
  Region output;                    ///< in the output grid
  Region source;                    ///< in the source grid, one voxel at least
  std::vector<std::int32_t> cells;  ///< of the mesh that may own voxels of it, ascending:
                                    ///< tetrahedra first, then hexahedra
  double host_bytes = 0;            ///< as the limits count them
  double device_bytes = 0;
};

/// The blocks of one step.
struct BlockPlan {
  std::vector<WarpBlock> blocks;  ///< neighbors follow each other; together the region, once
  std::int64_t tetrahedra = 0;    ///< as in Counts
  std::int64_t inverted = 0;
  std::int64_t flat = 0;
};

/// Cuts the steps of a series into blocks.
class TETWARP_EXPORT BlockPlanner {
 public:
  /// @param source   grid of the sources
  /// @param mesh     kept by the caller, unchanged
  /// @param options  as for a Warper of the whole
  /// @throws std::invalid_argument on a bad mesh
  BlockPlanner(const Grid& source, const Mesh& mesh, const WarpOptions& options);
  BlockPlanner(BlockPlanner&&) noexcept;
  ~BlockPlanner();

  /// Halves the region, along the axis that lets its halves read least, until every block keeps to
  /// the limits. Costs a few times the setup of a step; memory: 100 bytes per tetrahedron.
  /// @param deformed  world, host memory, as many nodes as the mesh
  /// @throws std::invalid_argument  on positions too far away, or when the smallest block exceeds
  ///                                the limits
  BlockPlan plan(const PositionsView& deformed, const BlockLimits& limits);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The part of a mesh that a block needs.
struct TETWARP_EXPORT BlockMesh {
  Mesh mesh;
  std::vector<std::int32_t> nodes;  ///< of the whole mesh, one per node of the part

  /// The positions of these nodes.
  std::vector<Point3> of(const std::vector<Point3>& positions) const;
};

/// Cuts out a block's cells, or the first of all where it has none: a mesh has one at least. Nodes
/// keep their order, so that hexahedra are split alike.
TETWARP_EXPORT BlockMesh block_mesh(const Mesh& mesh, const WarpBlock& block);

}  // namespace tetwarp
