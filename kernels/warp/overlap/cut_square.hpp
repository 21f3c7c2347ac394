/// @file cut_square.hpp
/// The part of a unit square within half-planes: faces of a voxel's box cut by a tetrahedron.
#pragma once
#include "kernels/base/hd.hpp"

namespace tetwarp {

/// offset + u slope[0] + v slope[1] >= 0.
struct HalfPlane {
  double offset, slope[2];
};

// The square and at most five half-planes: two sides of a box and three faces of a tetrahedron.
constexpr int max_square_corners = 9;

/// A convex polygon within [-0.5, 0.5]^2, counterclockwise.
struct CutSquare {
  int count;
  double corner[max_square_corners][2];

  TETWARP_HD void set_whole() {
    count = 4;
    for (int c = 0; c < 4; ++c) {
      corner[c][0] = c == 1 || c == 2 ? 0.5 : -0.5;
      corner[c][1] = c > 1 ? 0.5 : -0.5;
    }
  }

  /// Cuts the polygon. @returns false if nothing remains
  TETWARP_HD bool cut(const HalfPlane& side) {
    const double reach = 0.5 * (fabs(side.slope[0]) + fabs(side.slope[1]));
    if (side.offset >= reach) return true;
    if (side.offset <= -reach) return false;
    return cut_corners(side);
  }

 private:
  TETWARP_HD static double height_of(const HalfPlane& side, const double* x) {
    return side.offset + side.slope[0] * x[0] + side.slope[1] * x[1];
  }

  TETWARP_HD_RARE bool cut_corners(const HalfPlane& side) {
    double kept[max_square_corners][2];
    int kept_count = 0;
    const auto keep = [&](double u, double v) {
      if (kept_count == max_square_corners) return;
      kept[kept_count][0] = u;
      kept[kept_count++][1] = v;
    };
    const double* last = corner[count - 1];
    double last_height = height_of(side, last);
    for (int c = 0; c < count; ++c) {
      const double* const now = corner[c];
      const double height = height_of(side, now);
      if ((height < 0) != (last_height < 0)) {
        const double share = last_height / (last_height - height);
        keep(last[0] + share * (now[0] - last[0]), last[1] + share * (now[1] - last[1]));
      }
      if (!(height < 0)) keep(now[0], now[1]);
      last = now;
      last_height = height;
    }
    for (int c = 0; c < kept_count; ++c) {
      corner[c][0] = kept[c][0];
      corner[c][1] = kept[c][1];
    }
    count = kept_count;
    return count > 2;
  }
};

}  // namespace tetwarp
