/// @file majorant.hpp
/// A diagonal matrix that is larger than J M^-1 J^T, for iterations that move all contacts at once.
///
/// Let W_b be the part of J M^-1 J^T that is due to body b, D_b its diagonal, and lambda_b the
/// largest eigenvalue of D_b^-1 W_b. The sum over the bodies of lambda_b D_b is then larger than
/// J M^-1 J^T. Each body has its own factor, so that hundreds of contacts on one body do not slow
/// down those of another.
///
/// lambda_b is estimated from below by a power iteration and multiplied by a margin. If the result
/// is still too small, a step changes velocities by more than 1.3 times what the majorant allows;
/// the caller then doubles the majorant.
#pragma once
#include <cstdint>

#include "kernels/contact/touching_rows.hpp"

namespace tetwarp {

/// Contacts in the frames of their bodies.
struct TouchingNodes {
  CompliantBodies bodies;
  TouchingRows rows;
  View<const double> turned;            ///< J in frames, [blocks][9]
  View<const std::int32_t> part_start;  ///< [contacts + 1] parts of each contact
  View<const std::int32_t> part_block;  ///< [parts + 1] first block of each part
  View<const std::int32_t> part_body;   ///< [parts]

  /// u += J z of blocks [begin, end) of a contact.
  TETWARP_HD void add_velocity(std::int64_t begin,
                               std::int64_t end,
                               const double* z,
                               double* u) const {
    for (std::int64_t b = begin; b < end; ++b) {
      const double* const j = turned.data + 9 * b;
      const double* const v = z + 3 * std::int64_t{rows.node[b]};
      for (int a = 0; a < 3; ++a) {
        u[a] += j[3 * a] * v[0] + j[3 * a + 1] * v[1] + j[3 * a + 2] * v[2];
      }
    }
  }
  /// J^T r of every 32nd contact on a node, in the frame of its body.
  /// @param r  (block, axis): impulse of the contact of a block
  template <class Impulse>
  TETWARP_HD PlainSums<3> push_part(std::int64_t node, int lane, const Impulse& r) const {
    const std::int64_t row = bodies.row_of_node[node];
    PlainSums<3> sum;
    for (std::int64_t t = rows.touch_start[row] + lane; t < rows.touch_start[row + 1]; t += 32) {
      const std::int64_t b = rows.touch[t];
      const double* const j = turned.data + 9 * b;
      for (int a = 0; a < 3; ++a) {
        const double own = r(b, a);
        for (int i = 0; i < 3; ++i) sum.value[i] += j[3 * a + i] * own;
      }
    }
    return sum;
  }
  /// The block that a part adds to its own contact in J M^-1 J^T.
  TETWARP_HD void own_block(std::int64_t part, double* block) const {
    for (int e = 0; e < 9; ++e) block[e] = 0;
    const std::int64_t begin = part_block[part], end = part_block[part + 1];
    for (std::int64_t b = begin; b < end; ++b) {
      for (std::int64_t c = begin; c < end; ++c) add_product(b, c, block);
    }
  }

 private:
  /// block += J_b C J_c^T.
  TETWARP_HD void add_product(std::int64_t b, std::int64_t c, double* block) const {
    const CompliantBody& own = bodies.of_row(rows.row[b]);
    const std::int64_t size = 3 * std::int64_t{own.node_count};
    const float* const between = bodies.compliance.data + own.compliance +
                                 3 * (rows.node[c] - std::int64_t{own.first_node}) * size +
                                 3 * (rows.node[b] - std::int64_t{own.first_node});
    const double *const first = turned.data + 9 * b, *const second = turned.data + 9 * c;
    for (int k = 0; k < 3; ++k) {
      double moved[3];  // column k of C J_c^T
      for (int i = 0; i < 3; ++i) {
        moved[i] = 0;
        for (int j = 0; j < 3; ++j) moved[i] += double{between[j * size + i]} * second[3 * k + j];
      }
      for (int a = 0; a < 3; ++a) {
        for (int i = 0; i < 3; ++i) block[3 * a + k] += first[3 * a + i] * moved[i];
      }
    }
  }
};

/// One index = one block of J: turns it into the frame of its body.
struct TurnJacobianOp {
  CompliantBodies of;
  TouchingRows rows;
  View<double> turned;  ///< out

  TETWARP_HD void operator()(std::int64_t block) const {
    const CompliantBody& own = of.of_row(rows.row[block]);
    for (std::int64_t a = 9 * block; a < 9 * block + 9; a += 3) {
      of.to_frame(own, rows.jacobian.data + a, turned.data + a);
    }
  }
};

/// Numbers of magnitude 0.5 to 1.5 with scattered signs, so that contacts all around a body do not
/// cancel.
TETWARP_HD double scattered(std::int64_t i) {
  auto bits = static_cast<std::uint32_t>(i) * 2654435769u;
  bits = (bits ^ (bits >> 15)) * 2246822519u;
  bits ^= bits >> 13;
  const double size = 0.5 + static_cast<double>(bits >> 8) / (1 << 24);
  return (bits & 1u) != 0 ? size : -size;
}

/// One index = one contact: its own block, the diagonals of its parts, and the start vector of the
/// power iteration.
struct OwnBlockOp {
  TouchingNodes of;
  View<ContactConstants<double>> constants;  ///< in and out
  View<double> diagonal, vector;             ///< out, [parts][3]

  TETWARP_HD void operator()(std::int64_t contact) const {
    ContactConstants<double>& own = constants[contact];
    for (int e = 0; e < 9; ++e) own.block[e] = 0;
    for (std::int64_t p = of.part_start[contact]; p < of.part_start[contact + 1]; ++p) {
      double block[9];
      of.own_block(p, block);
      for (int e = 0; e < 9; ++e) own.block[e] += block[e];
      for (int a = 0; a < 3; ++a) {
        diagonal[3 * p + a] = block[4 * a];
        vector[3 * p + a] = block[4 * a] > 0 ? scattered(3 * p + a) / sqrt(block[4 * a]) : 0;
      }
    }
    own.tangent_metric =
        larger_eigenvalue(own.block[4], (own.block[5] + own.block[7]) / 2, own.block[8]);
  }
};

/// One index = one node: J^T v of the contacts on it, with v the vector of each part. By lanes.
struct PartPushOp {
  using Sum = PlainSums<3>;
  static constexpr int lanes = 32;

  TouchingNodes of;
  View<const double> vector;  ///< [parts][3]
  View<double> push;          ///< out, [nodes][3]

  TETWARP_HD Sum part(std::int64_t node, int lane) const {
    return of.push_part(node, lane, [this](std::int64_t block, int axis) {
      return vector[3 * std::int64_t{of.rows.part[block]} + axis];
    });
  }
  TETWARP_HD void finish(std::int64_t node, const Sum& sum) const {
    for (int i = 0; i < 3; ++i) push[3 * node + i] = sum.value[i];
  }
};

/// One index = one part: D_b^-1 J z, the next vector.
struct PartVectorOp {
  TouchingNodes of;
  View<const double> node_velocity, diagonal;
  View<double> vector;  ///< out

  TETWARP_HD void operator()(std::int64_t part) const {
    double u[3] = {0, 0, 0};
    of.add_velocity(of.part_block[part], of.part_block[part + 1], node_velocity.data, u);
    for (int a = 0; a < 3; ++a) {
      const double own = diagonal[3 * part + a];
      vector[3 * part + a] = own > 0 ? u[a] / own : 0;
    }
  }
};

/// One index = one body: lambda_b from two steps of the power iteration. With z the velocities
/// before, v = D_b^-1 J z and q = J^T v, lambda_b is about q . C q / q . z. It is at most the
/// number of rows, three per contact. By lanes.
struct BodyScaleOp {
  using Sum = PlainSums<2>;
  static constexpr int lanes = 32;
  static constexpr double margin = 1.2;  ///< the estimate grows towards lambda_b

  CompliantBodies of;
  View<const double> push, before, after;  ///< q, z, C q, [nodes][3]
  View<double> scale;                      ///< out, [bodies]

  TETWARP_HD Sum part(std::int64_t body, int lane) const {
    const CompliantBody& own = of.bodies[body];
    const std::int64_t begin = 3 * std::int64_t{own.first_node};
    const std::int64_t end = begin + 3 * std::int64_t{own.node_count};
    Sum sums;
    for (std::int64_t i = begin + lane; i < end; i += lanes) {
      sums.value[0] += push[i] * after[i];
      sums.value[1] += push[i] * before[i];
    }
    return sums;
  }
  TETWARP_HD void finish(std::int64_t body, const Sum& sums) const {
    const double above = sums.value[0], below = sums.value[1];
    const double most = 3.0 * of.bodies[body].contact_count;
    scale[body] = above < most * below ? max_of(min_of(margin * above / below, most), 1.0) : most;
  }
};

/// One index = one contact: its constants, with the majorant in place of its own block.
struct MajorantOp {
  TouchingNodes of;
  View<const ContactConstants<double>> constants;
  View<const double> diagonal, scale;       ///< [parts][3]; [bodies]
  View<ContactConstants<double>> majorant;  ///< out

  TETWARP_HD void operator()(std::int64_t contact) const {
    ContactConstants<double> own = constants[contact];
    for (int e = 0; e < 9; ++e) own.block[e] = 0;
    for (std::int64_t p = of.part_start[contact]; p < of.part_start[contact + 1]; ++p) {
      for (int a = 0; a < 3; ++a) {
        own.block[4 * a] += scale[of.part_body[p]] * diagonal[3 * p + a];
      }
    }
    own.tangent_metric = max_of(own.block[4], own.block[8]);
    majorant[contact] = own;
  }
};

/// One index = one contact: doubles its majorant.
struct MajorantGrowOp {
  View<ContactConstants<double>> majorant;  ///< in and out

  TETWARP_HD void operator()(std::int64_t contact) const {
    for (int e = 0; e < 9; ++e) majorant[contact].block[e] *= 2;
    majorant[contact].tangent_metric *= 2;
  }
};

struct MajorantArrays {
  View<ContactConstants<double>> constants;  ///< in and out: own blocks
  View<ContactConstants<double>> majorant;   ///< out
  View<double> scale;                        ///< out, [bodies]
  View<double> diagonal, vector;             ///< work, [parts][3]
  View<double> push, before, after;          ///< work, [nodes][3]
};

/// Sets the own blocks of all contacts, and their constants with majorants in place of these.
/// @param exec  where to run
///
/// Determinism: same bits on every back end with contraction off. Cost: that of eight steps of the
/// iteration that uses them.
template <class Exec>
void set_majorants(Exec& exec, const TouchingNodes& touching, const MajorantArrays& to) {
  constexpr const char* label = "body/contact";
  constexpr int power_steps = 6;
  const CompliantBodies& bodies = touching.bodies;
  const std::int64_t contacts = to.constants.size, nodes = bodies.row_of_node.size;
  exec.for_each(label, contacts, OwnBlockOp{touching, to.constants, to.diagonal, to.vector});
  for (int n = 0;; ++n) {
    exec.for_each_by_lanes(label, nodes, PartPushOp{touching, to.vector, to.push});
    exec.for_each_by_lanes(label, nodes,
                           NodeMoveOp{bodies, to.push, {}, n < power_steps ? to.before : to.after});
    if (n == power_steps) break;
    exec.for_each(label, touching.part_body.size,
                  PartVectorOp{touching, to.before, to.diagonal, to.vector});
  }
  exec.for_each_by_lanes(label, bodies.bodies.size,
                         BodyScaleOp{bodies, to.push, to.before, to.after, to.scale});
  exec.for_each(label, contacts,
                MajorantOp{touching, to.constants, to.diagonal, to.scale, to.majorant});
}

}  // namespace tetwarp
