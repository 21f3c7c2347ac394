/// @file vertex_box.hpp
/// Stage "vertex_box" of collision detection: the space that each vertex passes through.
#pragma once
#include <cstdint>

#include "kernels/collide/collide_item.hpp"

namespace tetwarp {

// A search makes boxes larger than its motion needs, so that boxes of later motions of the step,
// which differ little, lie within them: they are for a search distance of this many thicknesses,
// and inflated by this fraction of a vertex's displacement.
constexpr double found_thicknesses = 2.5;
constexpr double found_fraction = 0.25;

/// Successive vertices of one body, or boxes of such runs.
struct VertexRun {
  std::int32_t begin, end, body;
};

struct RunBox {
  Box box;              ///< of all vertices of the run
  std::int32_t leaves;  ///< 1: a box is not within the one found before
};

/// One index = one run of vertices. Writes the boxes of its vertices, or compares them with those
/// found before, and writes their union.
/// A box contains the vertex during the whole motion. It is inflated by the vertex's radius, its
/// sagitta and half the search distance, so that features within that distance have boxes that
/// overlap. The pairs of items come from the larger boxes `found`; later motions whose boxes lie
/// within them need no new pairs.
struct VertexBoxOp {
  View<const VertexRun> runs;
  MotionView motion;
  View<const double> radius;
  double half_distance;        ///< half of the search distance [m]
  double found_half_distance;  ///< [m], at least half_distance
  double fraction;             ///< of a vertex's displacement, by which `found` is inflated
  std::int32_t finds;          ///< 1: writes `found`; 0: compares with it
  View<Box> found;             ///< [vertices]
  View<RunBox> run_boxes;      ///< out: unions of the boxes written or compared; then their unions

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

  /// The box of a vertex, inflated also by four roundings of its coordinates.
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

/// One index = one run of boxes. Writes their union after them.
struct BoxUniteOp {
  View<const VertexRun> runs;
  std::int64_t first;  ///< first run of `runs`; also the place of its union in `boxes`
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
