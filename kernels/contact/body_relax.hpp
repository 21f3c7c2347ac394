/// @file body_relax.hpp
/// Stage "relax" of the contact solver: body velocities from impulses, and the block-Jacobi step of
/// A v = b + J^T r for bodies that A couples.
#pragma once
#include <cstdint>

#include "kernels/base/from_index.hpp"
#include "kernels/base/view.hpp"
#include "kernels/contact/contact_setup.hpp"

namespace tetwarp {

/// The contacts of each block, in ascending order.
struct BlockContacts {
  View<const std::int64_t> start;    ///< [blocks + 1]
  View<const std::int32_t> contact;  ///< contacts that act on the block
  View<const std::int64_t> value;    ///< where the Jacobian and the response of that pair start
};

/// One index = one block: v = v_free + A^-1 J^T r, added in the order of the contacts.
template <class T>
struct BodyVelocityOp {
  BlockContacts contacts;
  View<const std::int64_t> dof_start;
  View<const T> response;
  View<const T> impulse;
  View<const T> free;
  View<T> body_velocity;

  TETWARP_HD void operator()(std::int64_t b) const {
    const std::int64_t first = dof_start[b];
    const int size = static_cast<int>(dof_start[b + 1] - first);
    for (int k = 0; k < size; ++k) body_velocity[first + k] = free[first + k];
    for (std::int64_t p = contacts.start[b]; p < contacts.start[b + 1]; ++p) {
      const T* r = impulse.data + 3 * std::int64_t{contacts.contact[p]};
      const T* own_response = response.data + contacts.value[p];
      for (int k = 0; k < size; ++k) {
        body_velocity[first + k] += own_response[3 * k] * r[0] + own_response[3 * k + 1] * r[1] +
                                    own_response[3 * k + 2] * r[2];
      }
    }
  }
};

/// A in rows of dense blocks.
template <class T>
struct SystemView {
  View<const std::int64_t> row_start;    ///< [blocks + 1], first block of each row
  View<const std::int32_t> column;       ///< [entries], block column
  View<const std::int64_t> value_start;  ///< [entries], first number of each entry
  View<const T> values;                  ///< row by row within an entry
  View<const std::int64_t> dof_start;    ///< [blocks + 1]
  bool has_only_nodes;                   ///< all blocks have three dofs
};

/// sum += M y for one 3 x 3 block.
template <class T>
TETWARP_HD void add_node_product(const T* m, const T* y, T* sum) {
  sum[0] += m[0] * y[0] + m[1] * y[1] + m[2] * y[2];
  sum[1] += m[3] * y[0] + m[4] * y[1] + m[5] * y[2];
  sum[2] += m[6] * y[0] + m[7] * y[1] + m[8] * y[2];
}

/// out = A x in one block row. Products of 3 x 3 blocks are summed in registers. If all blocks are
/// 3 x 3, no sizes are read, which reduces the time to two thirds.
template <class T>
TETWARP_HD void multiply_block_row(const SystemView<T>& a, std::int64_t b, const T* x, T* out) {
  if (a.has_only_nodes) {
    T sum[3] = {0, 0, 0};
    for (std::int64_t k = a.row_start[b]; k < a.row_start[b + 1]; ++k) {
      add_node_product(a.values.data + a.value_start[k], x + 3 * std::int64_t{a.column[k]}, sum);
    }
    for (int i = 0; i < 3; ++i) out[i] = sum[i];
    return;
  }
  const int rows = static_cast<int>(a.dof_start[b + 1] - a.dof_start[b]);
  for (int i = 0; i < rows; ++i) out[i] = 0;
  T sum[3] = {0, 0, 0};
  for (std::int64_t k = a.row_start[b]; k < a.row_start[b + 1]; ++k) {
    const T* m = a.values.data + a.value_start[k];
    const std::int64_t from = a.dof_start[a.column[k]];
    const T* y = x + from;
    const int columns = static_cast<int>(a.dof_start[a.column[k] + 1] - from);
    if (rows == 3 && columns == 3) {
      add_node_product(m, y, sum);
      continue;
    }
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < columns; ++j) out[i] += m[i * columns + j] * y[j];
    }
  }
  for (int i = 0; i < min_of(rows, 3); ++i) out[i] += sum[i];
}

/// One index = one block: the defect d = b + J^T r - A v.
template <class T>
struct BodyDefectOp {
  SystemView<T> system;
  BlockContacts contacts;
  View<const T> jacobian;
  View<const T> load;
  View<const T> impulse;
  View<const T> body_velocity;
  View<T> defect;

  TETWARP_HD void operator()(std::int64_t b) const {
    const std::int64_t first = system.dof_start[b];
    const int size = static_cast<int>(system.dof_start[b + 1] - first);
    T* d = defect.data + first;
    multiply_block_row(system, b, body_velocity.data, d);
    for (int k = 0; k < size; ++k) d[k] = load[first + k] - d[k];
    for (std::int64_t p = contacts.start[b]; p < contacts.start[b + 1]; ++p) {
      const T* r = impulse.data + 3 * std::int64_t{contacts.contact[p]};
      const T* j = jacobian.data + contacts.value[p];
      for (int k = 0; k < size; ++k) {
        d[k] += j[k] * r[0] + j[size + k] * r[1] + j[2 * size + k] * r[2];
      }
    }
  }
};

/// out = keep out + factor M x for one dense block; size 3, by far the most frequent, has no loops.
template <class T>
TETWARP_HD void update_block(const T* m, int size, T keep, T factor, const T* x, T* out) {
  if (size == 3) {
    const T a = x[0], b = x[1], c = x[2];
    const T sum[3] = {m[0] * a + m[1] * b + m[2] * c, m[3] * a + m[4] * b + m[5] * c,
                      m[6] * a + m[7] * b + m[8] * c};
    for (int i = 0; i < 3; ++i) out[i] = keep * out[i] + factor * sum[i];
    return;
  }
  for (int i = 0; i < size; ++i) {
    T sum = 0;
    for (int k = 0; k < size; ++k) sum += m[i * size + k] * x[k];
    out[i] = keep * out[i] + factor * sum;
  }
}

/// One index = one block: v += omega D^-1 d.
template <class T>
struct BodyRelaxOp {
  View<const std::int64_t> dof_start;
  View<const std::int64_t> inverse_start;
  View<const T> inverse;
  T relaxation;
  View<const T> defect;
  View<T> body_velocity;

  TETWARP_HD void operator()(std::int64_t b) const {
    const std::int64_t first = dof_start[b];
    const int size = static_cast<int>(dof_start[b + 1] - first);
    update_block(inverse.data + inverse_start[b], size, T(1), relaxation, defect.data + first,
                 body_velocity.data + first);
  }
};

/// One index = one block: v = x + omega D^-1 (b + J^T r - A x). x and v are different memory.
template <class T>
struct BodyStepOp {
  BodyDefectOp<T> defect;  ///< of x
  View<const std::int64_t> inverse_start;
  View<const T> inverse;
  T relaxation;
  View<T> body_velocity;

  TETWARP_HD void operator()(std::int64_t b) const {
    defect(b);
    const std::int64_t first = defect.system.dof_start[b];
    const int size = static_cast<int>(defect.system.dof_start[b + 1] - first);
    for (int k = 0; k < size; ++k) body_velocity[first + k] = defect.body_velocity[first + k];
    update_block(inverse.data + inverse_start[b], size, T(1), relaxation,
                 defect.defect.data + first, body_velocity.data + first);
  }
};

/// One index = one block: copies the diagonal of A in its dofs.
template <class T>
struct DiagonalOp {
  View<const std::int64_t> dof_start;
  View<const std::int64_t> diagonal_value;
  View<const T> system;
  std::int64_t first_dof;  ///< dof of diagonal[0]
  View<double> diagonal;

  TETWARP_HD void operator()(std::int64_t b) const {
    const std::int64_t size = dof_start[b + 1] - dof_start[b];
    for (std::int64_t k = 0; k < size; ++k) {
      diagonal[dof_start[b] + k - first_dof] = system[diagonal_value[b] + k * (size + 1)];
    }
  }
};

/// Runs one of the bodies above for blocks [first, last).
///
/// Determinism: same bits on every back end with contraction off; contacts are gathered in order.
template <class Exec, class Op>
TETWARP_ANY_EXEC void body_relax(Exec& exec, std::int64_t first, std::int64_t last, const Op& op) {
  exec.for_each("contact/relax", last - first, FromIndex<Op>{op, first});
}

}  // namespace tetwarp
