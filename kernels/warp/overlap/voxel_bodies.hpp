/// @file voxel_bodies.hpp
/// The parts of a voxel's box in several tetrahedra, moved to the source. Where two of them meet in
/// a face, its integrals for the two cancel, and it is left out.
#pragma once
#include <cstdint>

#include "kernels/warp/overlap/voxel_part.hpp"

namespace tetwarp {

/// The part of a voxel's box in one tetrahedron.
struct VoxelBody {
  int tet;
  int cuts;          ///< bit f: the plane of face f cuts the box
  int met;           ///< bit f: face f is also one of another body
  double weight;     ///< of its volume in the source; its sign is that of the volume of the map
  double height[4];  ///< from place_of_box()
  SourceMap<double> map;  ///< (0, 0, 0) is the voxel
};

/// Few bodies of one voxel.
class VoxelBodies {
 public:
  TETWARP_HD int count() const { return count_; }
  TETWARP_HD bool is_full() const { return count_ == capacity; }
  TETWARP_HD void clear() { count_ = 0; }

  /// Memory for a body, which add() takes over. @pre not is_full()
  TETWARP_HD VoxelBody& next() { return bodies_[count_]; }
  TETWARP_HD void add() { ++count_; }
  TETWARP_HD const VoxelBody& body(int b) const { return bodies_[b]; }

  /// Its faces without those that it shares with another body.
  TETWARP_HD PartFaces faces(int b, const TetSetup* setups) const {
    const VoxelBody& body = bodies_[b];
    return {setups[body.tet], body.height, body.map, body.weight, body.cuts, body.met};
  }

  /// All its faces.
  TETWARP_HD PartFaces all_faces(int b, const TetSetup* setups) const {
    const VoxelBody& body = bodies_[b];
    return {setups[body.tet], body.height, body.map, body.weight, body.cuts, 0};
  }

  /// Finds the faces that two bodies share.
  /// @param tets  node indices, shape [tet_count][4]
  TETWARP_HD void meet(const TetSetup* setups, const std::int32_t* tets) {
    for (int b = 1; b < count_; ++b) {
      for (int a = 0; a < b; ++a) meet_two(setups, tets, bodies_[a], bodies_[b]);
    }
  }

  /// Makes all positions relative to map.whole of the first body.
  /// @param range  out, source voxels around the voxel's box moved by any of the maps; its volume
  ///               is the sum of theirs, weighted
  TETWARP_HD void align(VoxelRange& range) {
    const int* const whole = bodies_[0].map.whole;
    double volume = 0;
    for (int b = 0; b < count_; ++b) {
      SourceMap<double>& map = bodies_[b].map;
      for (int row = 0; row < 3; ++row) {
        map.base[row] += static_cast<double>(map.whole[row] - whole[row]);
        map.whole[row] = whole[row];
      }
      const VoxelRange own = range_of_box(map);
      volume += own.volume * fabs(bodies_[b].weight);
      for (int row = 0; row < 3; ++row) {
        range.first[row] = b == 0 ? own.first[row] : min_of(range.first[row], own.first[row]);
        range.last[row] = b == 0 ? own.last[row] : max_of(range.last[row], own.last[row]);
      }
    }
    range.volume = volume;
  }

 private:
  static constexpr int capacity = 8;

  /// The face of `tet` opposite its only node that `other` lacks; -1 if it lacks none or several.
  TETWARP_HD static int face_towards(const std::int32_t* tet, const std::int32_t* other) {
    int face = -1, lacking = 0;
    for (int n = 0; n < 4; ++n) {
      const std::int32_t node = tet[n];
      if (node == other[0] || node == other[1] || node == other[2] || node == other[3]) continue;
      face = n;
      ++lacking;
    }
    return lacking == 1 ? face : -1;
  }

  /// The maps of two tetrahedra agree on a face that they share. It counts once for each, with
  /// opposite signs if they lie on different sides of it at rest.
  TETWARP_HD static void meet_two(const TetSetup* setups,
                                  const std::int32_t* tets,
                                  VoxelBody& a,
                                  VoxelBody& b) {
    const std::int32_t* const a_nodes = tets + std::int64_t{4} * a.tet;
    const std::int32_t* const b_nodes = tets + std::int64_t{4} * b.tet;
    const int a_face = face_towards(a_nodes, b_nodes);
    if (a_face < 0) return;
    const int b_face = face_towards(b_nodes, a_nodes);
    if (b_face < 0 || (a.met >> a_face & 1) != 0 || (b.met >> b_face & 1) != 0) return;
    if (fabs(fabs(a.weight) - fabs(b.weight)) > 0x1p-46 * fabs(a.weight)) return;
    const auto &p = setups[a.tet].plane, &q = setups[b.tet].plane;
    const double facing =
        p[0][a_face] * q[0][b_face] + p[1][a_face] * q[1][b_face] + p[2][a_face] * q[2][b_face];
    if (!(facing * (a.weight > 0 ? 1 : -1) * (b.weight > 0 ? 1 : -1) < 0)) return;
    a.met |= 1 << a_face;
    b.met |= 1 << b_face;
  }

  int count_ = 0;
  VoxelBody bodies_[capacity];
};

}  // namespace tetwarp
