/// @file source_shares.hpp
/// Volumes of a convex body in the boxes of source voxels, from the edges of its faces alone.
///
/// By the divergence theorem, the part of a body at x in [a, a + 1] within a bar of voxels along x
/// has the volume of the integral of min(max(x - a, 0), 1) over its surface, dA the area projected
/// along x. By Green's theorem the integral over a face is one along its boundary. Neither body nor
/// face is cut at the planes between voxels: edges are, and a face gets a pair of opposite edges
/// (a chord) along the planes of the axis along which it extends least. These planes separate the
/// parts of a face, slabs, in which its integrand is a polynomial in each voxel.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {

TETWARP_HD void set_cross(const double* a, const double* b, double* cross) {
  cross[0] = a[1] * b[2] - a[2] * b[1];
  cross[1] = a[2] * b[0] - a[0] * b[2];
  cross[2] = a[0] * b[1] - a[1] * b[0];
}

/// Signed volume in the source per volume in the output.
TETWARP_HD double map_volume(const SourceMap<double>& map) {
  double cross[3];
  set_cross(map.axis[1], map.axis[2], cross);
  return map.axis[0][0] * cross[0] + map.axis[0][1] * cross[1] + map.axis[0][2] * cross[2];
}

/// Most corners of a face.
constexpr int max_face_corners = 9;

/// Shares below this times the box around a body are rounding: it is not in these voxels.
constexpr double least_share = 0x1p-49;

/// A flat convex face of a body. Voxel n of the source along an axis is [n, n + 1].
struct SourceFace {
  int count;
  double corner[max_face_corners][3];  ///< [source voxel]
  double normal[3];  ///< of the side from which the corners are counterclockwise, any length
  double weight;     ///< of the body; negative if that side is the inside of the body
};

/// Integrals over the faces of a body in a block of source voxels.
class SourceShares {
 public:
  static constexpr int edge = 5;  ///< most voxels of a block along each axis

  /// Begins with an empty body.
  /// @param first   voxel of the block
  /// @param voxels  of the block along each axis, at most `edge`
  TETWARP_HD void set_block(const int* first, const int* voxels) {
    for (int axis = 0; axis < 3; ++axis) {
      first_[axis] = first[axis];
      size_[axis] = voxels[axis];
    }
    row_ = size_[0] + 1;
    for (int n = 0; n < row_ * size_[1] * size_[2]; ++n) factors_[n] = {0, 0, 0};
  }

  /// Adds a face of the body.
  TETWARP_HD void add_face(const SourceFace& face) {
    const double* const normal = face.normal;
    const double x = fabs(normal[0]), y = fabs(normal[1]), z = fabs(normal[2]);
    if (x >= y && x >= z) {
      if (x > 0) add_slabs<0>(face, face.weight, -normal[1] / normal[0]);
    } else if (x > 0) {
      if (y > z) {
        add_slabs<1>(face, -face.weight * normal[0] / normal[1], 0);
      } else {
        add_slabs<2>(face, face.weight * normal[0] / normal[2], 0);
      }
    }
  }

  /// Calls visit(i, j, k, volume) for the voxels of the block that share more than `least` with the
  /// body.
  template <class Visit>
  TETWARP_HD void for_voxels(double least, Visit&& visit) const {
    for (int k = 0; k < size_[2]; ++k) {
      for (int j = 0; j < size_[1]; ++j) {
        const Factors* const bar = factors_ + row_ * (k * size_[1] + j);
        // Of all voxels behind i: the sum of `twice`, and the share of i in them.
        double twice = bar[size_[0]].twice, behind = bar[size_[0]].once + 0.5 * twice;
        for (int i = size_[0] - 1; i >= 0; --i) {
          const double volume = bar[i].sample + behind;
          if (volume > least) visit(first_[0] + i, first_[1] + j, first_[2] + k, volume);
          behind += bar[i].once + (twice + 0.5 * bar[i].twice);
          twice += bar[i].twice;
        }
      }
    }
  }

 private:
  /// Factors of integrals of the source along x, up to the lower side of a voxel: of the integral
  /// of the integral, of the integral, and of the sample of the voxel itself.
  struct Factors {
    double twice, once, sample;
  };
  /// What the integrals along the edges of a face have in common.
  struct FaceTerms {
    double weight;  ///< of the integral along the boundary
    double slope;   ///< slab 0: change of x along y within the face at constant z
    int start;      ///< slab 0: y at which integrals along y begin [voxel]
  };
  /// A point of the boundary and its voxel: -1 before the block, the block's size behind it.
  struct Point {
    double x[3];
    int cell[3];
  };
  /// The ends of the face's cut with a plane between slabs: where the boundary leaves the lower
  /// slab, and where it enters it.
  struct Chord {
    double end[2][3];
  };

  TETWARP_HD int cell_of(double x, int axis) const {
    return static_cast<int>(min_of(max_of(x, -0.5), static_cast<double>(size_[axis])) + 1) - 1;
  }

  template <int slab>
  TETWARP_HD_RARE void add_slabs(const SourceFace& face, double weight, double slope) {
    if (face.count < 3) return;
    Point points[max_face_corners];
    for (int c = 0; c < face.count; ++c) {
      for (int axis = 0; axis < 3; ++axis) {
        points[c].x[axis] = face.corner[c][axis] - first_[axis];
        points[c].cell[axis] = cell_of(points[c].x[axis], axis);
      }
    }
    const FaceTerms terms = {weight, slope, points[0].cell[1]};
    Chord chords[edge + 1];
    int low = points[0].cell[slab], high = low;
    const Point* last = &points[face.count - 1];
    for (int c = 0; c < face.count; ++c) {
      low = min_of(low, points[c].cell[slab]);
      high = max_of(high, points[c].cell[slab]);
      walk(
          *last, points[c],
          [&](const double* a, const double* b, const int* cell) {
            add_piece<slab>(terms, terms.weight, a, b, cell[0], cell[1], cell[2]);
          },
          [&](const double* x, int axis, int plane, bool is_upwards) {
            if (axis != slab) return;
            double* const end = chords[plane].end[is_upwards ? 0 : 1];
            for (int row = 0; row < 3; ++row) end[row] = x[row];
          });
      last = &points[c];
    }
    for (int plane = low + 1; plane <= high; ++plane) add_chord<slab>(terms, chords[plane], plane);
  }

  template <int slab>
  TETWARP_HD void add_chord(const FaceTerms& terms, const Chord& chord, int plane) {
    Point ends[2];
    for (int end = 0; end < 2; ++end) {
      for (int axis = 0; axis < 3; ++axis) {
        ends[end].x[axis] = chord.end[end][axis];
        ends[end].cell[axis] = axis == slab ? plane : cell_of(chord.end[end][axis], axis);
      }
    }
    walk(
        ends[0], ends[1],
        [&](const double* a, const double* b, const int* cell) {
          add_piece<slab>(terms, -terms.weight, a, b, cell[0], cell[1], cell[2]);
          add_piece<slab>(terms, terms.weight, a, b, cell[0] - (slab == 0), cell[1] - (slab == 1),
                          cell[2] - (slab == 2));
        },
        [](const double*, int, int, bool) {});
  }

  /// Calls piece(from, to, cell) for the parts of an edge in voxels, and between two of them
  /// cross(x, axis, plane, is_upwards): at x it crosses a plane x[axis] = plane.
  template <class Piece, class Cross>
  TETWARP_HD static void walk(const Point& from, const Point& to, Piece&& piece, Cross&& cross) {
    constexpr double never = 2;
    double share[3], a[3], b[3];
    int cell[3], step[3], left = 0;
    for (int axis = 0; axis < 3; ++axis) {
      cell[axis] = from.cell[axis];
      const int steps = to.cell[axis] - from.cell[axis];
      step[axis] = steps < 0 ? -1 : 1;
      left += steps * step[axis];
      share[axis] = steps == 0 ? never : share_at(from, to, axis, cell[axis] + (steps > 0));
      a[axis] = from.x[axis];
    }
    for (; left > 0; --left) {
      const int lower = share[1] < share[0] ? 1 : 0;
      const int axis = share[2] < share[lower] ? 2 : lower;
      const int plane = cell[axis] + (step[axis] > 0 ? 1 : 0);
      for (int row = 0; row < 3; ++row) {
        b[row] = from.x[row] + share[axis] * (to.x[row] - from.x[row]);
      }
      b[axis] = plane;
      piece(a, b, cell);
      cross(b, axis, plane, step[axis] > 0);
      for (int row = 0; row < 3; ++row) a[row] = b[row];
      cell[axis] += step[axis];
      share[axis] = cell[axis] == to.cell[axis]
                        ? never
                        : share_at(from, to, axis, cell[axis] + (step[axis] > 0 ? 1 : 0));
    }
    piece(a, to.x, cell);
  }

  /// Where an edge meets a plane: 0 at its beginning, 1 at its end.
  TETWARP_HD static double share_at(const Point& from, const Point& to, int axis, int plane) {
    const double share = (plane - from.x[axis]) / (to.x[axis] - from.x[axis]);
    return min_of(max_of(share, 0.0), 1.0);
  }

  /// Adds the integral along the part of an edge in voxel (i, j, k).
  template <int slab>
  TETWARP_HD void add_piece(const FaceTerms& terms,
                            double weight,
                            const double* a,
                            const double* b,
                            int i,
                            int j,
                            int k) {
    if (i < 0 || k < 0 || k >= size_[2]) return;
    Factors* const slice = factors_ + row_ * size_[1] * k + i;
    const double begin = a[0] - i, end = b[0] - i;
    if constexpr (slab != 0) {
      // Along the boundary: the integral of the source's integral along x.
      if (j < 0 || j >= size_[1]) return;
      constexpr int along = 3 - slab;
      const double length = weight * (b[along] - a[along]);
      Factors& at = slice[row_ * j];
      at.twice += length;
      at.once += length * (0.5 * (begin + end));
      at.sample += length * ((begin * (begin + end) + end * end) * (1.0 / 6));
    } else {
      // Along the boundary: the integral, over y from the start on, of the source's integral.
      const double length = weight * (b[2] - a[2]);
      const double x = 0.5 * (begin + end), y = 0.5 * (a[1] + b[1]);
      if (j != terms.start) {
        const int low = max_of(min_of(terms.start, j), 0);
        const int high = min_of(max_of(terms.start, j), size_[1]);
        const double whole = j < terms.start ? -length : length;
        for (int n = low; n < high; ++n) {
          slice[row_ * n].once += whole;
          slice[row_ * n].sample += whole * (x - terms.slope * (y - (n + 0.5)));
        }
      }
      if (j < 0 || j >= size_[1]) return;
      const double near = a[1] - j, far = b[1] - j;
      const double product =
          near * (begin + end) + far * end + (near * begin + far * (begin + end));
      const double square = near * (near + far) + far * far;
      Factors& at = slice[row_ * j];
      at.once += length * (y - j);
      at.sample += length * ((product - terms.slope * square) * (1.0 / 6));
    }
  }

  int first_[3];  ///< voxel
  int size_[3];   ///< voxels along each axis
  int row_;       ///< size_[0] + 1: the last is for all voxels behind the block
  Factors factors_[(edge + 1) * edge * edge];
};

}  // namespace tetwarp
