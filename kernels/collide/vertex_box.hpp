/// @file vertex_box.hpp
/// Stage "vertex_box" of collision detection: the space that each vertex passes through.
#pragma once
#include <cstdint>

#include "kernels/collide/collide_item.hpp"

namespace tetwarp {

// Boxes of a search are larger than those of the motion, so that later motions of the step, which
// differ little, lie within them: they suit a distance of so many thicknesses, and are inflated by
// this part of a vertex's way.
constexpr double found_thicknesses = 2.5;
constexpr double found_fraction = 0.25;

/// Successive vertices of one body, or boxes of such runs.
struct VertexRun {
  std::int32_t begin, end, body;
};

struct RunBox {
  Box box;              ///< of all vertices of the run
  std::int32_t leaves;  ///< a box is not within the one found before
};

/// One index = one run of vertices. Writes the boxes of its vertices, or compares them with those
/// found before, and writes their union.
///
/// A box holds the vertex during the whole motion, inflated by its radius, its sagitta and half the
/// distance that is looked for, so that features within that distance have boxes that overlap. The
/// larger boxes `found` are those that the pairs of items come from; later motions whose boxes lie
/// within them need no new pairs.
struct VertexBoxBody {
  View<const VertexRun> runs;
  MotionView motion;
  View<const double> radius;
  double half_distance;        ///< that is looked for [m]
  double found_half_distance;  ///< [m], at least half_distance
  double fraction;             ///< of a vertex's way: added to `found` on all sides
  std::int32_t finds;          ///< 1: writes `found`; 0: compares with it
  View<Box> found;             ///< [vertices]
  View<RunBox> run_boxes;      ///< out: of the boxes written, or of those compared; more follow

  TETWARP_HD void operator()(std::int64_t r) const {
    const VertexRun run = runs[r];
    RunBox all;
    all.leaves = 0;
    for (std::int32_t v = run.begin; v < run.end; ++v) {
      const double extra = radius[v] + motion.sagitta[v];
      Box box;
      if (finds != 0) {
        double way = 0;
        for (int k = 0; k < 3; ++k) {
          way = max_of(way, fabs(motion.end[3 * std::int64_t{v} + k] -
                                 motion.start[3 * std::int64_t{v} + k]));
        }
        box = box_of(v, extra + found_half_distance + fraction * way);
        found[v] = box;
      } else {
        box = box_of(v, extra + half_distance);
        if (!is_within(box, found[v])) all.leaves = 1;
      }
      if (v == run.begin) {
        all.box = box;
      } else {
        add_box(all.box, box);
      }
    }
    run_boxes[r] = all;
  }

  /// Inflated also by four roundings of the coordinates.
  TETWARP_HD Box box_of(std::int32_t v, double inflation) const {
    Box box;
    for (int k = 0; k < 3; ++k) {
      const double a = motion.start[3 * std::int64_t{v} + k],
                   b = motion.end[3 * std::int64_t{v} + k];
      const double rounding = 0x1p-50 * (max_of(fabs(a), fabs(b)) + inflation);
      box.low[k] = min_of(a, b) - inflation - rounding;
      box.high[k] = max_of(a, b) + inflation + rounding;
    }
    return box;
  }
};

/// One index = one run of boxes. Writes their union behind them.
struct BoxUniteBody {
  View<const VertexRun> runs;
  std::int64_t first;  ///< of `runs`, which is also the place of its union in `boxes`
  View<RunBox> boxes;  ///< in, out

  TETWARP_HD void operator()(std::int64_t i) const {
    const VertexRun run = runs[first + i];
    RunBox all = boxes[run.begin];
    for (std::int32_t k = run.begin + 1; k < run.end; ++k) {
      add_box(all.box, boxes[k].box);
      all.leaves |= boxes[k].leaves;
    }
    boxes[first + i] = all;
  }
};

}  // namespace tetwarp
