/// @file cell_overlap.cpp
/// Cuts the planes between the voxels of a cell, and sums their parts per voxel.
#include "host/warp/cpu/cell_overlap.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace tetwarp {
namespace {
constexpr std::int64_t half_voxel = quanta_per_voxel / 2;
constexpr double voxels_per_quantum = 1.0 / static_cast<double>(quanta_per_voxel);

/// Sign of a permutation of 0 to 3.
int parity_of(const int* order) {
  int sign = 1;
  for (int a = 1; a < 4; ++a) {
    for (int b = 0; b < a; ++b) sign = order[b] > order[a] ? -sign : sign;
  }
  return sign;
}

/// Number of a voxel among those of its cell.
int voxel_in_cell(const int* x) {
  return (x[2] * cell_edge + x[1]) * cell_edge + x[0];
}

bool meets_cell(const IntervalRange& range) {
  return range.first < cell_edge && range.last >= 0;
}

/// The nodes of a tetrahedron on both sides of a plane: those of one side, then those of the other.
struct Sides {
  int order[4];
  int first_count;  ///< nodes of the first side: 1, or 2
  bool is_first_below;

  Sides(const std::int64_t (*x)[3], int axis, std::int64_t plane) {
    int below[4], above[4], below_count = 0, above_count = 0;
    for (int n = 0; n < 4; ++n) {
      (x[n][axis] < plane ? below[below_count++] : above[above_count++]) = n;
    }
    is_first_below = below_count <= above_count;
    first_count = is_first_below ? below_count : above_count;
    std::copy_n(below, below_count, order + (is_first_below ? 0 : above_count));
    std::copy_n(above, above_count, order + (is_first_below ? below_count : 0));
  }
};
}  // namespace

void CellOverlap::run(std::int64_t cell) {
  if (op_.cell_work.size > 0 && op_.cell_work[cell] == keep_cell) return;
  op_.frame.set_corner(cell, corner_);
  if (is_compressed(cell)) {
    for (int voxel = 0; voxel < voxel_count; ++voxel) integrate_alone(voxel);
    return;
  }
  collect(cell);
  store();
}

void CellOverlap::collect(std::int64_t cell) {
  op_.frame.set_corner(cell, corner_);
  memory_.parts.clear();
  memory_.facets.clear();
  constexpr int none = std::numeric_limits<int>::max();
  memory_.reach.fill({{none, none, none, none}, {none, none, none, none}});
  const std::int64_t end = end_of_cell(op_.list, cell);
  for (std::int64_t p = op_.list.ranges[cell].begin; p < end; ++p) {
    const int t = tet_of(op_.list.pairs[p]);
    if (mesh_.sides[t] != 0) add_tet(t);
  }
  memory_.facets.push_back({-1, -1, memory_.parts.size()});
}

/// Whether the tetrahedra of a cell take many voxels of the source into one of the output.
bool CellOverlap::is_compressed(std::int64_t cell) const {
  constexpr double most = 64;  // voxels of the source, on average
  double source = 0, output = 0;
  const std::int64_t end = end_of_cell(op_.list, cell);
  for (std::int64_t p = op_.list.ranges[cell].begin; p < end; ++p) {
    const int t = tet_of(op_.list.pairs[p]);
    if (mesh_.sides[t] == 0) continue;
    const double volume = std::abs(mesh_.volumes[t]);
    source += volume;
    output += volume * (mesh_.voxel_ratio / op_.transforms[t].scale);
  }
  return source > most * output;
}

bool CellOverlap::is_in_frame(const int* x) const {
  bool is_in = true;
  for (int axis = 0; axis < 3; ++axis) {
    is_in = is_in && x[axis] >= op_.frame.begin[axis] && x[axis] < op_.frame.end[axis];
  }
  return is_in;
}

/// @param x  out: where a voxel of the cell is in the frame
void CellOverlap::place_of(int voxel, int* x) const {
  x[0] = corner_[0] + voxel % cell_edge;
  x[1] = corner_[1] + voxel / cell_edge % cell_edge;
  x[2] = corner_[2] + voxel / (cell_edge * cell_edge);
}

void CellOverlap::integrate_alone(int voxel) const {
  int x[3];
  place_of(voxel, x);
  if (is_in_frame(x)) op_(op_.frame.offset_of(x[0], x[1], x[2]) - op_.first);
}

void CellOverlap::add_tet(int t) {
  Tet tet;
  set_tet(t, tet);
  if (tet.is_flat && is_zero(tet.flat)) return;
  add_planes<0>(tet);
  add_planes<1>(tet);
  add_planes<2>(tet);
  for (int face = 0; face < 4; ++face) {
    const std::int32_t other = mesh_.neighbors[4 * t + face];
    int voxel[3];
    const bool is_met =
        !tet.is_flat && other >= 0 && mesh_.sides[other] != 0 && !is_flat(other, voxel);
    if (!is_met) add_face(tet, face);
  }
}

void CellOverlap::set_tet(int t, Tet& tet) const {
  const TetNodes output = tet_nodes(mesh_.nodes, op_.tets.data + 4 * t);
  const TetNodes source = tet_nodes(mesh_.rest, op_.tets.data + 4 * t);
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t low = source.x[0][axis];
    for (int n = 1; n < 4; ++n) low = std::min(low, source.x[n][axis]);
    tet.origin[axis] = static_cast<int>((low + half_voxel) >> quantum_bits);
    for (int n = 0; n < 4; ++n) {
      tet.quanta[n][axis] =
          output.x[n][axis] + half_voxel - std::int64_t{corner_[axis]} * quanta_per_voxel;
      tet.output[n][axis] = static_cast<double>(tet.quanta[n][axis]) * voxels_per_quantum;
      const std::int64_t from =
          source.x[n][axis] + half_voxel - std::int64_t{tet.origin[axis]} * quanta_per_voxel;
      tet.source[n][axis] = static_cast<double>(from) * voxels_per_quantum;
    }
  }
  tet.side = mesh_.sides[t];
  tet.is_flat = is_flat(t, tet.flat);
}

/// Whether all samples around the part of a tetrahedron in the cell are the same. They need no
/// cuts: their integral is that of one sample over the whole part.
/// @param voxel  out, one of them
bool CellOverlap::is_flat(int t, int* voxel) const {
  if (op_.source.data == nullptr) return false;
  double start[3], linear[3][3];
  map_start(op_.setups[t], corner_, start, linear);
  const TetNodes rest = tet_nodes(mesh_.rest, op_.tets.data + 4 * t);
  int past[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double* const steps = linear[axis];
    const double center = start[axis] + 0.5 * (cell_edge - 1) * (steps[0] + steps[1] + steps[2]);
    const double reach =
        0.5 * cell_edge * (std::abs(steps[0]) + std::abs(steps[1]) + std::abs(steps[2]));
    std::int64_t low = rest.x[0][axis], high = low;
    for (int n = 1; n < 4; ++n) {
      low = std::min(low, rest.x[n][axis]);
      high = std::max(high, rest.x[n][axis]);
    }
    const double first = std::max(center - reach, static_cast<double>(low) * voxels_per_quantum);
    const double last = std::min(center + reach, static_cast<double>(high) * voxels_per_quantum);
    if (!(first >= -0.5 && last <= op_.dims[axis] - 0.5 && first <= last)) return false;
    voxel[axis] = std::min(floor_of(first + 0.5), op_.dims[axis] - 1);
    past[axis] = std::max(voxel[axis] + 1, -floor_of(-last - 0.5));
  }
  bool is_same = true;
  with_numbers(op_.source.data, op_.source.kind, [&](const auto* samples) {
    const auto at = [&](int i, int j, int k) {
      return samples + ((std::int64_t{k} * op_.dims[1] + j) * op_.dims[0] + i) * op_.components;
    };
    const auto* const one = at(voxel[0], voxel[1], voxel[2]);
    for (int k = voxel[2]; k < past[2] && is_same; ++k) {
      for (int j = voxel[1]; j < past[1] && is_same; ++j) {
        const auto* const row = at(voxel[0], j, k);
        for (int n = 0; n < (past[0] - voxel[0]) * op_.components && is_same; ++n) {
          is_same = row[n] == one[n % op_.components];
        }
      }
    }
  });
  return is_same;
}

bool CellOverlap::is_zero(const int* voxel) const {
  const std::int64_t bar = std::int64_t{voxel[2]} * op_.dims[1] + voxel[1];
  const std::int64_t first = (bar * op_.dims[0] + voxel[0]) * op_.components;
  bool is_zero = true;
  for (int c = 0; c < op_.components; ++c) is_zero = is_zero && op_.source.at(first + c) == 0;
  return is_zero;
}

/// The section of a tetrahedron with a plane between voxels.
/// @param plane  of the voxels of the cell, n is between voxels n - 1 and n
/// @param is_upwards  out: its corners are counterclockwise from above, in the source
template <int axis>
Polygon<6> CellOverlap::section_of(const Tet& tet, int plane, bool& is_upwards) {
  const std::int64_t at = plane * quanta_per_voxel;
  const Sides sides(tet.quanta, axis, at);
  Polygon<6> section;
  const auto append_cut = [&](int one, int other) {
    const bool is_below = tet.quanta[one][axis] < at;
    const int lower = is_below ? one : other, upper = is_below ? other : one;
    const double share = static_cast<double>(at - tet.quanta[lower][axis]) /
                         static_cast<double>(tet.quanta[upper][axis] - tet.quanta[lower][axis]);
    Polygon<6>::Corner cut;
    for (int n = 0; n < 3; ++n) {
      const double from = tet.source[lower][n], out = tet.output[lower][n];
      cut.x[n] = from + share * (tet.source[upper][n] - from);
      cut.x[3 + n] = out + share * (tet.output[upper][n] - out);
    }
    cut.x[3 + axis] = plane;
    section.append(cut);
  };
  const int* const node = sides.order;
  if (sides.first_count == 1) {
    for (int n = 1; n < 4; ++n) append_cut(node[0], node[n]);
  } else {
    append_cut(node[0], node[2]);
    append_cut(node[0], node[3]);
    append_cut(node[1], node[3]);
    append_cut(node[1], node[2]);
  }
  // The corners are counterclockwise from the second side if the order of the nodes is positive.
  is_upwards = (parity_of(node) * tet.side > 0) == sides.is_first_below;
  return section;
}

/// Adds the squares in the planes between voxels that are normal to an axis.
template <int axis>
void CellOverlap::add_planes(const Tet& tet) {
  constexpr int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::int64_t low = tet.quanta[0][axis], high = low;
  for (int n = 1; n < 4; ++n) {
    low = std::min(low, tet.quanta[n][axis]);
    high = std::max(high, tet.quanta[n][axis]);
  }
  const auto begin = std::max<std::int64_t>(0, (low >> quantum_bits) + 1);
  const auto end = std::min<std::int64_t>(cell_edge, high >> quantum_bits);
  for (auto plane = static_cast<int>(begin); plane <= end; ++plane) {
    bool is_upwards;
    const Polygon<6> section = section_of<axis>(tet, plane, is_upwards);
    const IntervalRange along_u(section, 3 + u);
    if (!meets_cell(along_u) || !meets_cell(IntervalRange(section, 3 + v))) continue;
    for_intervals<3 + u>(section, along_u, 0, cell_edge, [&](int a, const Polygon<6>& strip) {
      const IntervalRange range(strip, 3 + v);
      for_intervals<3 + v>(strip, range, 0, cell_edge, [&](int b, const Polygon<6>& square) {
        int x[3];
        x[u] = a;
        x[v] = b;
        x[axis] = plane;
        const int upper = plane < cell_edge ? voxel_in_cell(x) : -1;
        x[axis] = plane - 1;
        const int lower = plane > 0 ? voxel_in_cell(x) : -1;
        add_facet(tet, square, is_upwards ? lower : upper, is_upwards ? upper : lower);
      });
    });
  }
}

/// Adds the parts of a face in the boxes of the voxels.
void CellOverlap::add_face(const Tet& tet, int face) {
  int order[4] = {face, (face + 1) % 4, (face + 2) % 4, (face + 3) % 4};
  if (parity_of(order) * tet.side < 0) std::swap(order[2], order[3]);
  Polygon<6> whole;
  for (int n = 1; n < 4; ++n) {
    const double *const from = tet.source[order[n]], *const out = tet.output[order[n]];
    whole.append({{from[0], from[1], from[2], out[0], out[1], out[2]}});
  }
  const IntervalRange along_k(whole, 5);
  for (const int axis : {3, 4, 5}) {
    if (!meets_cell(IntervalRange(whole, axis))) return;
  }
  for_intervals<5>(whole, along_k, 0, cell_edge, [&](int k, const Polygon<6>& layer) {
    const IntervalRange along_j(layer, 4);
    for_intervals<4>(layer, along_j, 0, cell_edge, [&](int j, const Polygon<6>& bar) {
      const IntervalRange along_i(bar, 3);
      for_intervals<3>(bar, along_i, 0, cell_edge, [&](int i, const Polygon<6>& part) {
        const int x[3] = {i, j, k};
        add_facet(tet, part, voxel_in_cell(x), -1);
      });
    });
  });
}

void CellOverlap::add_facet(const Tet& tet, const Polygon<6>& square, int inner, int outer) {
  Polygon<3> facet;
  for (int c = 0; c < square.count; ++c) {
    const double* const x = square.corner[c].x;
    facet.append({{x[0], x[1], x[2]}});
  }
  memory_.facets.push_back({inner, outer, memory_.parts.size()});
  Reach reach = {};
  if (tet.is_flat) {
    for (int axis = 0; axis < 3; ++axis) {
      reach.first[axis] = tet.flat[axis];
      reach.minus_last[axis] = -tet.flat[axis];
    }
    memory_.parts.add_part(facet, tet.flat[0] - tet.origin[0], tet.flat);
  } else {
    const IntervalRange ranges[3] = {{facet, 0}, {facet, 1}, {facet, 2}};
    for (int axis = 0; axis < 3; ++axis) {
      reach.first[axis] = tet.origin[axis] + ranges[axis].first;
      reach.minus_last[axis] = -(tet.origin[axis] + ranges[axis].last);
    }
    memory_.parts.add(facet, ranges, tet.origin);
  }
  for (const int voxel : {inner, outer}) {
    if (voxel >= 0) memory_.reach[voxel].include(reach);
  }
}

void CellOverlap::store() {
  constexpr std::int64_t most = std::int64_t{1} << 18;  // sums at a time
  for (int begin = 0; begin < voxel_count;) {
    if (memory_.reach[begin].sum_count() > most) {
      integrate_alone(begin++);
      continue;
    }
    int end = begin;
    std::int64_t size = 0;
    for (; end < voxel_count; ++end) {
      const std::int64_t next = memory_.reach[end].sum_count();
      if (size + next > most) break;
      memory_.start[end] = size;
      size += next;
    }
    memory_.sums.assign(static_cast<std::size_t>(size), 0.0);
    add_parts(begin, end);
    with_numbers(op_.source.data, op_.source.kind, [&](const auto* samples) {
      for (int voxel = begin; voxel < end; ++voxel) store(voxel, samples);
    });
    begin = end;
  }
}

/// Adds the parts of all facets to the sums of voxels [begin, end).
void CellOverlap::add_parts(int begin, int end) {
  for (std::size_t f = 0; f + 1 < memory_.facets.size(); ++f) {
    const FacetPart* const first = memory_.parts.data() + memory_.facets[f].first_part;
    const FacetPart* const past = memory_.parts.data() + memory_.facets[f + 1].first_part;
    const auto add_to = [&](int voxel, double side) {
      if (voxel < begin || voxel >= end) return;
      const Reach& reach = memory_.reach[voxel];
      double* const sums = memory_.sums.data() + memory_.start[voxel];
      for (const FacetPart* part = first; part < past; ++part) {
        double* const at = sums + reach.place_of(part->voxel);
        at[0] += side * part->area;
        at[1] += side * part->moment;
      }
    };
    add_to(memory_.facets[f].inner, 1.0);
    add_to(memory_.facets[f].outer, -1.0);
  }
}

/// Stores the integral of the source over the bodies of a voxel.
template <class T>
void CellOverlap::store(int voxel, const T* samples) const {
  int x[3];
  place_of(voxel, x);
  if (!is_in_frame(x)) return;
  double values[max_transform_components] = {};
  const Reach& reach = memory_.reach[voxel];
  if (!reach.is_empty()) {
    const int last[3] = {-reach.minus_last[0], -reach.minus_last[1], -reach.minus_last[2]};
    const double least = least_share * static_cast<double>(reach.sum_count() / 2);
    for (int k = std::max(reach.first[2], 0); k <= std::min(last[2], op_.dims[2] - 1); ++k) {
      for (int j = std::max(reach.first[1], 0); j <= std::min(last[1], op_.dims[1] - 1); ++j) {
        const int first[3] = {reach.first[0], j, k};
        const double* const sums =
            memory_.sums.data() + memory_.start[voxel] + reach.place_of(first);
        const T* const row =
            samples + (std::int64_t{k} * op_.dims[1] + j) * op_.dims[0] * op_.components;
        double beyond = 0;  // area of the parts of the surface in voxels beyond i
        for (int i = last[0]; i >= std::max(reach.first[0], 0); --i) {
          const double* const at = sums + std::int64_t{2} * (i - reach.first[0]);
          const double volume = at[1] + beyond;
          beyond += at[0];
          if (!(volume > least) || i >= op_.dims[0]) continue;
          for (int c = 0; c < op_.components; ++c) {
            values[c] += volume * static_cast<double>(row[i * op_.components + c]);
          }
        }
      }
    }
  }
  for (int c = 0; c < op_.components; ++c) values[c] *= mesh_.voxel_ratio;
  op_.output.store(op_.frame.offset_of(x[0], x[1], x[2]), x, values);
}

}  // namespace tetwarp
