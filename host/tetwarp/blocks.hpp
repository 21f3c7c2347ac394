/// @file blocks.hpp
/// A warp in blocks, for volumes larger than memory and for several processes. Each block of the
/// output needs a window of the source and a part of the mesh. The blocks together equal the warp
/// of the whole bit for bit.
///
///     WarpOptions block_options = options;
///     for (const WarpBlock& block : planner.plan(deformed, limits).blocks) {
///       const BlockMesh part = block_mesh(mesh, block);
///       block_options.region = block.output;
///       block_options.source_window = SourceWindow{block.source};
///       const VolumeView source(grid, type, components, samples_of(block.source), Memory::host);
///       Warper warper(std::span(&source, 1), part.mesh, block_options);
///       warper.step(part.of(deformed), target_of(block.output));
///     }
///
/// samples_of() and target_of() are functions of the caller that read a window and provide outputs.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/volume.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Limits of memory per block, and the memory that a voxel takes [byte].
struct BlockLimits {
  /// Host memory of a block. Source window and output count twice: the caller may read the next
  /// window and write the last output while a block is computed.
  double host = std::numeric_limits<double>::infinity();
  /// Device memory of a block. Source window and output count once.
  double device = std::numeric_limits<double>::infinity();
  double source_voxel = 4;   ///< one voxel of all sources together
  double output_voxel = 4;   ///< one voxel of all outputs together
  double scratch_voxel = 0;  ///< further memory of the back end per output voxel
  /// Blocks begin at multiples of this, counted from the beginning of the region [voxel].
  std::array<std::int64_t, 3> step{8, 8, 8};
  /// Output voxels of a block. Blocks of one `step` may exceed it.
  std::int64_t max_voxels = std::numeric_limits<std::int64_t>::max();
};

/// A part of the output, and the parts of source and mesh that it depends on.
struct WarpBlock {
  Region output;                    ///< in the output grid
  Region source;                    ///< in the source grid; at least one voxel
  std::vector<std::int32_t> cells;  ///< numbers of the mesh's cells that may own voxels of the
                                    ///< block, ascending: tetrahedra first, then hexahedra
  double host_bytes = 0;            ///< estimate to compare with BlockLimits::host
  double device_bytes = 0;          ///< estimate to compare with BlockLimits::device
};

/// The blocks of one step.
struct BlockPlan {
  std::vector<WarpBlock> blocks;  ///< disjoint, together the region; neighbors in succession
  std::int64_t tetrahedra = 0;    ///< of the whole mesh, as in Counts
  std::int64_t inverted = 0;      ///< of the whole mesh, as in Counts
  std::int64_t flat = 0;          ///< of the whole mesh, as in Counts
};

/// Divides the steps of a series into blocks.
class TETWARP_EXPORT BlockPlanner {
 public:
  /// @param source     grid of the sources
  /// @param mesh       of the whole; copied
  /// @param options    as for a Warper of the whole; `source_window` is ignored
  /// @param mid_nodes  those of a CurvedMesh: blocks then read what curved maps lead to
  /// @throws std::invalid_argument when the grid or the mesh is invalid
  BlockPlanner(const Grid& source,
               const Mesh& mesh,
               const WarpOptions& options,
               const std::vector<MidNodes>& mid_nodes = {});
  BlockPlanner(BlockPlanner&&) noexcept;
  ~BlockPlanner();

  /// Halves the region recursively until every block is within the limits, each time along the axis
  /// for which the two halves read the fewest source voxels. Takes a few times as long as the setup
  /// of a step, and 100 bytes of memory per tetrahedron.
  /// @param deformed  world, host memory, as many nodes as the mesh
  /// @throws std::invalid_argument  when positions are not finite or too far from the grid, or a
  ///                                block of one step exceeds the limits
  BlockPlan plan(const PositionsView& deformed, const BlockLimits& limits);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The part of a mesh that a block needs.
struct TETWARP_EXPORT BlockMesh {
  Mesh mesh;                        ///< with its own numbers of cells and nodes
  std::vector<std::int32_t> nodes;  ///< number in the whole mesh of each node of the part
  std::vector<MidNodes> mid_nodes;  ///< of its tetrahedra, as those of CurvedMesh

  /// Picks the positions of the part's nodes from those of the whole mesh.
  std::vector<Point3> of(const std::vector<Point3>& positions) const;
};

/// The mesh of a block's cells. For a block without cells: the first cell of the mesh, because a
/// Warper requires one. Cell c of the part is cell block.cells[c] of the mesh. Nodes keep their
/// order, so that hexahedra are split into the same tetrahedra.
/// @param mid_nodes  those of a CurvedMesh, for which check_mid_nodes() has passed
TETWARP_EXPORT BlockMesh block_mesh(const Mesh& mesh,
                                    const WarpBlock& block,
                                    const std::vector<MidNodes>& mid_nodes = {});

}  // namespace tetwarp
