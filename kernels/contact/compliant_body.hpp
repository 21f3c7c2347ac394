/// @file compliant_body.hpp
/// The dense matrices M^-1 by which bodies give way to impulses of contacts: of an elastic body the
/// inverse of its system at rest, R A_0^-1 R^T; of a single rigid body its own, A^-1; of other
/// bodies that A couples, omega D^-1 for each node and each rigid body, with D its diagonal block.
///
/// A solve numbers the rows of its bodies, body after body. Vectors [rows][3] are in the world; in
/// vectors "in frames" the numbers of elastic bodies are turned by R^T. A row on which a contact
/// acts, and the second row of a rigid body with it, is a node; nodes are numbered too. The
/// compliance of a body is the part of M^-1 between its nodes.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"
#include "kernels/body/row_product.hpp"

namespace tetwarp {

struct CompliantBody {
  const float* inverse = nullptr;     ///< A_0^-1, [3 count][3 count], symmetric; null: omega D^-1
  double relaxation = 1;              ///< omega, where omega D^-1 is used
  std::int32_t frame = -1;            ///< its rotation, -1: none
  bool is_joined = false;             ///< A couples its rows with those of other bodies of the list
  std::int32_t system_row = 0;        ///< its first row of the system
  std::int32_t first = 0, count = 0;  ///< its rows
  std::int32_t first_node = 0, node_count = 0;  ///< its nodes, in the order of their rows
  std::int32_t contact_count = 0;               ///< contacts that act on it
  std::int64_t compliance = 0;                  ///< first number of its compliance
};

struct CompliantBodies {
  View<const CompliantBody> bodies;
  View<const std::int32_t> body_of_row;  ///< [rows]
  View<const std::int32_t> row_of_node;  ///< [nodes]
  View<const double> rotation;           ///< [frames][9] R, rows first
  View<const float> compliance;          ///< of each body [3 nodes][3 nodes], columns first
  DiagonalInverse<double> diagonal;
  double damping = 1;  ///< factor of the compliance of elastic bodies

  TETWARP_HD const CompliantBody& of_row(std::int64_t row) const {
    return bodies[body_of_row[row]];
  }
  TETWARP_HD const CompliantBody& of_node(std::int64_t node) const {
    return of_row(row_of_node[node]);
  }
  /// out = R^T v.
  TETWARP_HD void to_frame(const CompliantBody& own, const double* v, double* out) const {
    const double* const r = rotation.data + 9 * std::int64_t{own.frame};
    for (int i = 0; i < 3; ++i) {
      out[i] = own.frame < 0 ? v[i] : r[i] * v[0] + r[3 + i] * v[1] + r[6 + i] * v[2];
    }
  }
  /// out = R v.
  TETWARP_HD void to_world(const CompliantBody& own, const double* v, double* out) const {
    const double* const r = rotation.data + 9 * std::int64_t{own.frame};
    for (int i = 0; i < 3; ++i) {
      out[i] = own.frame < 0 ? v[i] : r[3 * i] * v[0] + r[3 * i + 1] * v[1] + r[3 * i + 2] * v[2];
    }
  }
  /// Velocities for unit forces on the three numbers of `source`, in the frame of the body.
  /// @param target, source  rows of the same body
  /// @param block           out, [3][3], row by row
  TETWARP_HD void block(std::int64_t target, std::int64_t source, double* block) const {
    const CompliantBody& own = of_row(target);
    const std::int64_t i = 3 * (target - own.first), j = 3 * (source - own.first);
    const std::int64_t size = 3 * std::int64_t{own.count};
    const double* const a = own.inverse == nullptr ? diagonal.at(own.system_row) : nullptr;
    for (int e = 0; e < 9; ++e) {
      const std::int64_t place = (j + e % 3) * size + i + e / 3;
      block[e] = a != nullptr ? own.relaxation * a[place] : damping * double{own.inverse[place]};
    }
  }
};

/// Index (node, other, item): one 3x3 block of the compliance of a body: the velocity of node
/// `other`, counted from the first node of the body, for unit impulses on `node`.
struct ComplianceBlockOp {
  CompliantBodies of;
  View<float> compliance;  ///< out

  TETWARP_HD void operator()(std::int64_t node, std::int64_t other, std::int64_t) const {
    const CompliantBody& own = of.of_node(node);
    double block[9];
    of.block(of.row_of_node[own.first_node + other], of.row_of_node[node], block);
    const std::int64_t size = 3 * std::int64_t{own.node_count};
    float* const out = compliance.data + own.compliance +
                       3 * (node - std::int64_t{own.first_node}) * size + 3 * other;
    for (int e = 0; e < 9; ++e) out[e % 3 * size + e / 3] = static_cast<float>(block[e]);
  }
};

/// One lane's part of the product of three rows of a matrix with a vector: every 32nd column. The
/// lanes of a warp read successive numbers of each row.
/// @param a     the first of the rows, [3][size]
/// @param size  columns
template <class T>
TETWARP_HD PlainSums<3> three_rows_part(const T* a,
                                        const double* vector,
                                        std::int64_t size,
                                        int lane) {
  PlainSums<3> sums;
  for (std::int64_t j = lane; j < size; j += 32) {
    for (int i = 0; i < 3; ++i) sums.value[i] += double{a[i * size + j]} * vector[j];
  }
  return sums;
}

/// One index = one node: the velocity caused by impulses on the nodes. By lanes.
struct NodeMoveOp {
  using Sum = PlainSums<3>;
  static constexpr int lanes = 32;

  CompliantBodies of;
  View<const double> push, from;  ///< [nodes][3] in frames; `from` may be empty: zero
  View<double> velocity;          ///< out: from + compliance push

  TETWARP_HD Sum part(std::int64_t node, int lane) const {
    const CompliantBody& own = of.of_node(node);
    const std::int64_t first = own.first_node, size = 3 * std::int64_t{own.node_count};
    const float* const a = of.compliance.data + own.compliance + 3 * (node - first) * size;
    return three_rows_part(a, push.data + 3 * first, size, lane);
  }
  TETWARP_HD void finish(std::int64_t node, const Sum& sum) const {
    for (int i = 0; i < 3; ++i) {
      velocity[3 * node + i] = (from.size == 0 ? 0 : from[3 * node + i]) + sum.value[i];
    }
  }
};

/// One index = one row: its numbers of M^-1 push, both in frames. By lanes.
struct ComplianceOp {
  using Sum = PlainSums<3>;
  static constexpr int lanes = 32;

  CompliantBodies of;
  View<const double> push;
  View<double> moved;  ///< out

  TETWARP_HD Sum part(std::int64_t row, int lane) const {
    const CompliantBody& own = of.of_row(row);
    const std::int64_t size = 3 * std::int64_t{own.count}, place = 3 * (row - own.first) * size;
    const double* const vector = push.data + 3 * std::int64_t{own.first};
    return own.inverse == nullptr
               ? three_rows_part(of.diagonal.at(own.system_row) + place, vector, size, lane)
               : three_rows_part(own.inverse + place, vector, size, lane);
  }
  TETWARP_HD void finish(std::int64_t row, const Sum& sum) const {
    const CompliantBody& own = of.of_row(row);
    const double factor = own.inverse == nullptr ? own.relaxation : of.damping;
    for (int i = 0; i < 3; ++i) moved[3 * row + i] = factor * sum.value[i];
  }
};

/// One index = one row: to = from + moved.
struct RowMoveOp {
  CompliantBodies of;
  View<const double> moved;  ///< in frames
  View<const double> from;
  View<double> to;  ///< out; may be `from`

  TETWARP_HD void operator()(std::int64_t row) const {
    double turned[3];
    of.to_world(of.of_row(row), moved.data + 3 * row, turned);
    for (int i = 0; i < 3; ++i) to[3 * row + i] = from[3 * row + i] + turned[i];
  }
};

/// One index = one node: its velocity in the frame of its body.
struct NodeVelocityOp {
  CompliantBodies of;
  View<const double> velocity;  ///< [rows][3]
  View<double> node_velocity;   ///< out, [nodes][3]

  TETWARP_HD void operator()(std::int64_t node) const {
    const std::int64_t row = of.row_of_node[node];
    of.to_frame(of.of_row(row), velocity.data + 3 * row, node_velocity.data + 3 * node);
  }
};

}  // namespace tetwarp
