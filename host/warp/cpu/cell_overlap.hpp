/// @file cell_overlap.hpp
/// Stage "raster" of a warp that keeps totals, on host threads: the voxels of a cell together.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "host/warp/cpu/facet_parts.hpp"
#include "kernels/warp/overlap/voxel_overlap.hpp"

namespace tetwarp {

/// What CellOverlap reads beside VoxelOverlapOp.
struct OverlapMesh {
  View<const Node> nodes;              ///< deformed, in the frame [quantum]
  View<const Node> rest;               ///< in the source's index space [quantum]
  View<const double> volumes;          ///< six times those at rest, signed
  View<const std::int8_t> sides;       ///< sign of the volume at rest; 0: it has no contents
  View<const std::int32_t> neighbors;  ///< from face_neighbors()
  double voxel_ratio;                  ///< volume of a voxel of the source over one of the output
};

/// Memory of CellOverlap, kept from cell to cell.
struct CellOverlapMemory {
  /// A facet between voxels of the cell; -1 where there is none.
  struct Facet {
    int inner, outer;  ///< the first one is behind the facet, along its normal
    std::int64_t first_part;
  };
  /// Voxels of the source around a voxel's bodies, first[axis] to -minus_last[axis]. The fourth
  /// numbers let compilers take all in vectors.
  struct Reach {
    int first[4], minus_last[4];

    void include(const Reach& other) {
      for (int n = 0; n < 4; ++n) first[n] = std::min(first[n], other.first[n]);
      for (int n = 0; n < 4; ++n) minus_last[n] = std::min(minus_last[n], other.minus_last[n]);
    }
    bool is_empty() const { return first[0] > -minus_last[0]; }
    std::int64_t size(int axis) const { return 1 - minus_last[axis] - first[axis]; }
    std::int64_t sum_count() const { return is_empty() ? 0 : 2 * size(0) * size(1) * size(2); }
    std::int64_t place_of(const int* voxel) const {
      const std::int64_t bar = (voxel[2] - first[2]) * size(1) + (voxel[1] - first[1]);
      return 2 * (bar * size(0) + (voxel[0] - first[0]));
    }
  };
  static constexpr int voxel_count = cell_edge * cell_edge * cell_edge;

  FacetParts parts;
  std::vector<Facet> facets;
  std::array<Reach, voxel_count> reach;
  std::array<std::int64_t, voxel_count> start;  ///< of a voxel's sums
  std::vector<double> sums;                     ///< per voxel of the source: area and moment
};

/// Integrals over the boxes of the voxels of a cell.
///
/// A voxel's body in a tetrahedron is bounded by the planes between the output's voxels and by the
/// tetrahedron's faces. Per tetrahedron each of these planes is cut once, into the squares between
/// two voxels, and these into their parts in the source's voxels (FacetParts): what a square adds
/// to one voxel it takes from the other. Faces in which two tetrahedra meet cancel. On which side
/// of a plane a node lies is decided in integers, and corners are interpolated between the two ends
/// of an edge, so that facets of neighbors fit without gaps also where planes nearly coincide.
///
/// VoxelOverlapOp takes cells where many voxels of the source go into one of the output, so that
/// facets have many parts, and voxels whose bodies are far from each other in the source.
class CellOverlap {
 public:
  /// The arguments must outlive the object.
  CellOverlap(const VoxelOverlapOp& op, const OverlapMesh& mesh, CellOverlapMemory& memory)
      : op_(op), mesh_(mesh), memory_(memory) {}

  /// Stores the values of a cell's voxels. The same bits for every region that a voxel is in.
  void run(std::int64_t cell);

  /// Leaves facets, their parts and what they reach of the source in the memory, for weights that
  /// serve all samples; the source may have none.
  void collect(std::int64_t cell);

 private:
  /// A tetrahedron in the cell: nodes from the lower side of the cell's first voxel, and in the
  /// source from `origin`.
  struct Tet {
    std::int64_t quanta[4][3];
    double output[4][3], source[4][3];
    int origin[3];
    int side;
    int flat[3];  ///< a voxel of the source whose sample is that of all around
    bool is_flat;
  };
  using Reach = CellOverlapMemory::Reach;
  static constexpr int voxel_count = CellOverlapMemory::voxel_count;

  bool is_compressed(std::int64_t cell) const;
  bool is_in_frame(const int* x) const;
  void place_of(int voxel, int* x) const;
  void integrate_alone(int voxel) const;
  void add_tet(int t);
  void set_tet(int t, Tet& tet) const;
  bool is_flat(int t, int* voxel) const;
  bool is_zero(const int* voxel) const;
  template <int axis>
  static Polygon<6> section_of(const Tet& tet, int plane, bool& is_upwards);
  template <int axis>
  void add_planes(const Tet& tet);
  void add_face(const Tet& tet, int face);
  void add_facet(const Tet& tet, const Polygon<6>& square, int inner, int outer);
  void store();
  void add_parts(int begin, int end);
  template <class T>
  void store(int voxel, const T* samples) const;

  const VoxelOverlapOp& op_;
  const OverlapMesh& mesh_;
  int corner_[3];  ///< first voxel of the cell [frame]
  CellOverlapMemory& memory_;
};

}  // namespace tetwarp
