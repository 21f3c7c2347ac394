/// @file vector_stages-inl.hpp
/// Definitions of VectorStages, for files that are compiled for one instruction set each.
///
/// All functions here are inlined or templates on the width of vectors, which differs between the
/// files: no code for one instruction set can be linked into another's.
///
/// Vectors are loaded by value, one by one: what is copied into an array of them passes memory in
/// halves with g++, and the load of a whole one then waits for both stores.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>

#include "host/simulate/step/cpu/lanes.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {

template <int width, class Vector, class T>
inline Vector loaded(const T* numbers) {
  Vector vector;
  __builtin_memcpy(&vector, numbers, sizeof(vector));
  return vector;
}
template <int width, class Vector, class T>
inline void store(const Vector& vector, T* numbers) {
  __builtin_memcpy(numbers, &vector, sizeof(vector));
}

/// The numbers of a vector in float64. They are listed, as g++ converts what
/// __builtin_convertvector() takes in halves.
template <int width, class Numbers, class Floats, std::size_t... k>
inline Numbers doubled(const Floats& floats, std::index_sequence<k...>) {
  return Numbers{floats[k]...};
}

/// R of count <= width lanes.
template <int width>
inline void lane_rotations(const Lanes<width>* f, int count, Lanes<width>* r) {
  const LaneMask<width> is_valid = rotation_by_quartic(f, r);
  for (int k = 0; k < count; ++k) {
    if (is_valid[k]) continue;
    double lane_f[9], lane_r[9];
    for (int i = 0; i < 9; ++i) lane_f[i] = f[i].v[k];
    nearest_rotation(lane_f, lane_r);
    for (int i = 0; i < 9; ++i) r[i].v[k] = lane_r[i];
  }
}

/// Tetrahedra index[0] to index[count - 1], count <= width; lanes from count on repeat the last.
template <int width>
inline void tet_force_lanes(const TetForceOp& op, const std::int32_t* index, int count) {
  using Real = Lanes<width>;
  const TetConstants& tets = op.tets;
  Real x[12], g[9], f[9], r[9], gradient[12], force[12], lambda, mu;
  std::int64_t own[width];
  for (int k = 0; k < width; ++k) own[k] = index[k < count ? k : count - 1];
  for (int a = 0; a < 4; ++a) {
    const std::int32_t* const corner = tets.corner.data + a * tets.count;
    for (int k = 0; k < width; ++k) {
      const double* const p = op.position.data + 3 * std::int64_t{corner[own[k]]};
      for (int i = 0; i < 3; ++i) x[3 * a + i].v[k] = p[i];
    }
  }
  for (int c = 0; c < 9; ++c) {
    const double* const from = tets.gradient.data + c * tets.count;
    for (int k = 0; k < width; ++k) g[c].v[k] = from[own[k]];
  }
  for (int k = 0; k < width; ++k) {
    lambda.v[k] = tets.volume_lambda[own[k]];
    mu.v[k] = tets.volume_mu[own[k]];
  }
  deformation_gradient(x, g, f);
  lane_rotations(f, count, r);
  corotated_forces(f, r, g, lambda, mu, gradient, force);
  alignas(64) double gradients[12][width], forces[12][width];
  for (int i = 0; i < 12; ++i) {
    __builtin_memcpy(gradients[i], &gradient[i].v, sizeof(gradients[i]));
    __builtin_memcpy(forces[i], &force[i].v, sizeof(forces[i]));
  }
  for (int k = 0; k < count; ++k) {
    op.store(own[k], gradients[0] + k, forces[0] + k, width);
  }
}

template <int width>
void tet_forces_of(const TetForceOp& op, std::int64_t begin, std::int64_t end) {
  std::int32_t index[width];
  int count = 0;
  for (std::int64_t t = begin; t < end; ++t) {
    if (op.is_at_rest(t)) {
      op.skip(t);
      continue;
    }
    index[count++] = static_cast<std::int32_t>(t);
    if (count < width) continue;
    tet_force_lanes<width>(op, index, count);
    count = 0;
  }
  if (count > 0) tet_force_lanes<width>(op, index, count);
}

/// The tetrahedra from `first` on, count <= width of them; adds their sums in order.
template <int width>
inline void tet_energy_lanes(const TetShapes& tets, std::int64_t first, int count, TetSums& sums) {
  using Real = Lanes<width>;
  Real x[12], g[9], f[9], r[9], cofactors[3], volume, lambda, mu;
  std::int64_t own[width];  // lanes from count on repeat the last
  for (int k = 0; k < width; ++k) own[k] = first + (k < count ? k : count - 1);
  for (int a = 0; a < 4; ++a) {
    for (int k = 0; k < width; ++k) {
      const double* const p = tets.position.data + 3 * std::int64_t{tets.nodes[4 * own[k] + a]};
      for (int i = 0; i < 3; ++i) x[3 * a + i].v[k] = p[i];
    }
  }
  for (int c = 0; c < 9; ++c) {
    for (int k = 0; k < width; ++k) g[c].v[k] = tets.gradient[9 * own[k] + c];
  }
  for (int k = 0; k < width; ++k) {
    volume.v[k] = tets.volume[own[k]];
    lambda.v[k] = tets.lambda[own[k]];
    mu.v[k] = tets.mu[own[k]];
  }
  deformation_gradient(x, g, f);
  lane_rotations(f, count, r);
  cross3(f + 3, f + 6, cofactors);
  const Real energy = corotated_energy(f, r, volume, lambda, mu);
  const Real determinant = dot3(f, cofactors);
  for (int k = 0; k < count; ++k) {
    sums.energy += energy.v[k];
    sums.inverted += determinant.v[k] < 0;
  }
}

template <int width>
TetSums tet_energies_of(const TetShapes& tets, std::int64_t begin, std::int64_t end) {
  TetSums sums;
  std::int64_t t = begin;
  for (; t + width <= end; t += width) tet_energy_lanes<width>(tets, t, width, sums);
  if (t < end) tet_energy_lanes<width>(tets, t, static_cast<int>(end - t), sums);
  return sums;
}

template <int width>
void assemble_of(const BlockAssembleOp& op, std::int64_t begin, std::int64_t end) {
  const BlockAssembleOpOf<LaneColumn> own{op.rows,      op.from,  op.scalars, op.rigid,
                                          op.time_step, op.skips, op.values,  op.is_skipped};
  for (std::int64_t k = begin; k < end; ++k) own(k);
}

/// GradientProductOp of rows [begin, end) with a block's column in a vector. Reads one number
/// beyond the last block.
template <int width, class T>
PlainSums<1> product_of(const GradientArrays<T>& a, std::int64_t begin, std::int64_t end) {
  typedef T Four __attribute__((vector_size(4 * sizeof(T))));
  constexpr std::int64_t blocks_ahead = 32;  // of what is read: prefetched
  PlainSums<1> sum{};
  const T* const p = a.p.data;
  for (std::int64_t row = begin; row < end; ++row) {
    Four q = {};
    for (std::int64_t k = a.rows.start[row]; k < a.rows.free_end[row]; ++k) {
      const T* const x = p + 3 * std::int64_t{a.rows.column[k]};
      __builtin_prefetch(a.copy.data + 9 * (k + blocks_ahead));
      const T* const block = a.copy.data + 9 * k;
      q += loaded<width, Four>(block) * x[0] + loaded<width, Four>(block + 3) * x[1] +
           loaded<width, Four>(block + 6) * x[2];
    }
    for (int i = 0; i < 3; ++i) {
      a.q[3 * row + i] = q[i];
      sum.value[0] += static_cast<double>(p[3 * row + i]) * static_cast<double>(q[i]);
    }
  }
  return sum;
}

template <int width>
void add_rows_of(
    const float* rows, std::int64_t stride, const double* change, std::int64_t size, double* sum) {
  typedef float Floats __attribute__((vector_size(4 * width)));
  typedef typename LaneVector<width>::Numbers Numbers;
  for (std::int64_t k = 0; k < size; k += width) {
    Numbers own = loaded<width, Numbers>(sum + k);
    for (int a = 0; a < 3; ++a) {
      const Floats row = loaded<width, Floats>(rows + a * stride + k);
      own += doubled<width, Numbers>(row, std::make_index_sequence<width>()) * change[a];
    }
    store<width>(own, sum + k);
  }
}

template <int width>
void add_rows_float_of(
    const float* rows, std::int64_t stride, const float* change, std::int64_t size, float* sum) {
  typedef float Eight __attribute__((vector_size(32)));
  for (std::int64_t k = 0; k < size; k += 8) {
    Eight own = loaded<width, Eight>(sum + k);
    for (int a = 0; a < 3; ++a) own += loaded<width, Eight>(rows + a * stride + k) * change[a];
    store<width>(own, sum + k);
  }
}

template <int width>
void add_blocks_of(const float* rows,
                   const std::int32_t* place,
                   std::int64_t parts,
                   const float* columns,
                   float* block) {
  typedef float Eight __attribute__((vector_size(32)));
  Eight a = loaded<width, Eight>(block), b = loaded<width, Eight>(block + 8);
  Eight c = loaded<width, Eight>(block + 16);
  for (std::int64_t p = 0; p < parts; ++p, rows += 9) {
    for (int i = 0; i < 3; ++i) {
      const Eight column = loaded<width, Eight>(columns + 8 * (std::int64_t{place[p]} + i));
      a += column * rows[i];
      b += column * rows[3 + i];
      c += column * rows[6 + i];
    }
  }
  store<width>(a, block);
  store<width>(b, block + 8);
  store<width>(c, block + 16);
}

template <int width>
void substitute_of(const BlockFactor& l, double* w) {
  typedef double Four __attribute__((vector_size(32)));
  typedef float FourFloats __attribute__((vector_size(16)));
  const auto column = [&](std::int64_t entry, int i) {
    return doubled<width, Four>(loaded<width, FourFloats>(l.block.data + 9 * entry + 3 * i),
                                std::make_index_sequence<4>());
  };
  const std::int64_t count = l.start.size - 1;
  for (std::int64_t j = 0; j < count; ++j) {
    double* const own = w + 4 * j;
    if (own[0] == 0 && own[1] == 0 && own[2] == 0) continue;
    const float* const d = l.diagonal.data + 6 * j;
    const double a = double{d[0]} * own[0], b = double{d[1]} * own[0] + double{d[2]} * own[1];
    const double c = double{d[3]} * own[0] + double{d[4]} * own[1] + double{d[5]} * own[2];
    own[0] = a, own[1] = b, own[2] = c;
    for (std::int64_t k = l.start[j]; k < l.start[j + 1]; ++k) {
      double* const out = w + 4 * std::int64_t{l.row[k]};
      const Four push = column(k, 0) * a + column(k, 1) * b + column(k, 2) * c;
      store<width>(loaded<width, Four>(out) - push, out);
    }
  }
  for (std::int64_t j = count; j-- > 0;) {
    Four sum[3] = {};
    for (std::int64_t k = l.start[j]; k < l.start[j + 1]; ++k) {
      const Four in = loaded<width, Four>(w + 4 * std::int64_t{l.row[k]});
      for (int i = 0; i < 3; ++i) sum[i] += column(k, i) * in;
    }
    double* const own = w + 4 * j;
    double rest[3];
    for (int i = 0; i < 3; ++i) rest[i] = own[i] - (sum[i][0] + sum[i][1] + sum[i][2]);
    const float* const d = l.diagonal.data + 6 * j;
    own[0] = double{d[0]} * rest[0] + double{d[1]} * rest[1] + double{d[3]} * rest[2];
    own[1] = double{d[2]} * rest[1] + double{d[4]} * rest[2];
    own[2] = double{d[5]} * rest[2];
  }
}

/// The numbers of each vector are those that BlockLu::solve() computes.
template <int width>
void substitute_four_of(const BlockPairFactor& lu, double* w) {
  typedef double Four __attribute__((vector_size(32)));
  const auto load = [w](std::int64_t row, int i) {
    return loaded<width, Four>(w + 12 * row + 4 * i);
  };
  const std::int64_t count = lu.start.size - 1;
  for (std::int64_t j = 0; j < count; ++j) {
    bool is_zero = true;  // as in most columns of sparse vectors
    for (int i = 0; i < 12; ++i) is_zero = is_zero && w[12 * j + i] == 0;
    if (is_zero) continue;
    const Four x = load(j, 0), y = load(j, 1), z = load(j, 2);
    for (std::int64_t e = lu.start[j] + 1; e < lu.start[j + 1]; ++e) {
      const double* const l = lu.lower + 12 * e;
      const std::int64_t row = lu.row[e];
      for (int i = 0; i < 3; ++i) {
        store<width>(load(row, i) - (x * l[i] + y * l[4 + i] + z * l[8 + i]), w + 12 * row + 4 * i);
      }
    }
  }
  for (std::int64_t j = count; j-- > 0;) {
    Four a = load(j, 0), b = load(j, 1), c = load(j, 2);
    for (std::int64_t e = lu.start[j] + 1; e < lu.start[j + 1]; ++e) {
      const double* const u = lu.upper + 12 * e;
      const std::int64_t row = lu.row[e];
      const Four x = load(row, 0), y = load(row, 1), z = load(row, 2);
      a -= x * u[0] + y * u[1] + z * u[2];
      b -= x * u[4] + y * u[5] + z * u[6];
      c -= x * u[8] + y * u[9] + z * u[10];
    }
    const double* const inverse = lu.inverse + 9 * j;
    for (int i = 0; i < 3; ++i) {
      store<width>(a * inverse[3 * i] + b * inverse[3 * i + 1] + c * inverse[3 * i + 2],
                   w + 12 * j + 4 * i);
    }
  }
}

template <int width>
void subtract_products_of(const double* blocks,
                          const std::int32_t* rows,
                          std::int64_t count,
                          const std::int32_t* slot,
                          const double* factor,
                          double* out) {
  typedef double Four __attribute__((vector_size(32)));
  for (std::int64_t e = 0; e < count; ++e, blocks += 12) {
    double* const own = out + 12 * std::int64_t{slot[rows[e]]};
    const Four x = loaded<width, Four>(blocks), y = loaded<width, Four>(blocks + 4);
    const Four z = loaded<width, Four>(blocks + 8);
    for (int c = 0; c < 3; ++c) {
      const Four push = x * factor[c] + y * factor[4 + c] + z * factor[8 + c];
      store<width>(loaded<width, Four>(own + 4 * c) - push, own + 4 * c);
    }
  }
}

template <int width>
constexpr VectorStages vector_stages_of(const char* name) {
  return {name,
          tet_forces_of<width>,
          tet_energies_of<width>,
          assemble_of<width>,
          product_of<width, double>,
          product_of<width, float>,
          add_rows_of<width>,
          add_rows_float_of<width>,
          add_blocks_of<width>,
          substitute_of<width>,
          substitute_four_of<width>,
          subtract_products_of<width>};
}

}  // namespace tetwarp
