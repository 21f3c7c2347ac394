/// @file majorant.hpp
/// A diagonal matrix that is larger than J M^-1 J^T: for the steps of an iteration that moves all
/// contacts at once.
///
/// Let W_b be the part of J M^-1 J^T that body b makes, D_b its diagonal, and lambda_b the largest
/// eigenvalue of D_b^-1 W_b. Then the sum over the bodies of lambda_b D_b is larger than all of
/// J M^-1 J^T. A body with a few contacts so does not slow down because another one has hundreds.
#pragma once
#include <cstdint>

#include "kernels/elastic/touching_rows.hpp"

namespace tetwarp {

/// Contacts in the frames of their bodies.
struct TouchingNodes {
  CompliantBodies bodies;
  TouchingRows rows;
  View<const double> turned;       ///< J in frames, [blocks][9]
  View<const std::int32_t> sides;  ///< [contacts][2] body of each side, -1: does not move

  /// u += J z of the blocks of a contact; of one side, or with -1 of both.
  TETWARP_HD void add_velocity(std::int64_t contact, int side, const double* z, double* u) const {
    for (std::int64_t b = rows.block_start[contact]; b < rows.block_start[contact + 1]; ++b) {
      if (side >= 0 && rows.side[b] != side) continue;
      const double* const j = turned.data + 9 * b;
      const double* const v = z + 3 * std::int64_t{rows.node[b]};
      for (int a = 0; a < 3; ++a) {
        u[a] += j[3 * a] * v[0] + j[3 * a + 1] * v[1] + j[3 * a + 2] * v[2];
      }
    }
  }
  /// The block of a contact and itself in J M^-1 J^T that one side makes.
  TETWARP_HD void own_block(std::int64_t contact, int side, double* block) const {
    for (int e = 0; e < 9; ++e) block[e] = 0;
    const std::int64_t begin = rows.block_start[contact], end = rows.block_start[contact + 1];
    for (std::int64_t b = begin; b < end; ++b) {
      for (std::int64_t c = begin; c < end; ++c) {
        if (rows.side[b] == side && rows.side[c] == side) add_product(b, c, block);
      }
    }
  }

 private:
  /// block += J_b C J_c^T
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

/// One index = one block of J: turns it.
struct TurnJacobianBody {
  CompliantBodies of;
  TouchingRows rows;
  View<double> turned;  ///< out

  TETWARP_HD void operator()(std::int64_t block) const {
    const CompliantBody& own = of.of_row(rows.row[block]);
    for (int a = 0; a < 3; ++a) {
      own.to_frame(rows.jacobian.data + 9 * block + 3 * a, turned.data + 9 * block + 3 * a);
    }
  }
};

/// One index = one contact: its own block, the diagonals of its sides, and a vector to start the
/// power iteration from.
struct OwnBlockBody {
  TouchingNodes of;
  View<ContactConstants<double>> constants;  ///< in and out
  View<double> side_diagonal, vector;        ///< out, [contacts][2][3]

  TETWARP_HD void operator()(std::int64_t contact) const {
    ContactConstants<double>& own = constants[contact];
    for (int e = 0; e < 9; ++e) own.block[e] = 0;
    for (int side = 0; side < 2; ++side) {
      double block[9];
      of.own_block(contact, side, block);
      for (int e = 0; e < 9; ++e) own.block[e] += block[e];
      for (int a = 0; a < 3; ++a) {
        const std::int64_t place = 6 * contact + 3 * side + a;
        side_diagonal[place] = block[4 * a];
        vector[place] = block[4 * a] > 0 ? (1 + 0.1 * a) / sqrt(block[4 * a]) : 0;
      }
    }
    own.tangent_metric =
        larger_eigenvalue(own.block[4], (own.block[5] + own.block[7]) / 2, own.block[8]);
  }
};

/// One index = one node: J^T v of the contacts on it, each with the vector of its side.
struct SidePushBody {
  TouchingNodes of;
  View<const double> vector;  ///< [contacts][2][3]
  View<double> push;          ///< out, [nodes][3]

  TETWARP_HD void operator()(std::int64_t node) const {
    const TouchingRows& rows = of.rows;
    const std::int64_t row = of.bodies.row_of_node[node];
    double sum[3] = {0, 0, 0};
    for (std::int64_t t = rows.touch_start[row]; t < rows.touch_start[row + 1]; ++t) {
      const std::int64_t b = rows.touch[t];
      const double* const v = vector.data + 6 * std::int64_t{rows.contact[b]} + 3 * rows.side[b];
      const double* const j = of.turned.data + 9 * b;
      for (int a = 0; a < 3; ++a) {
        for (int i = 0; i < 3; ++i) sum[i] += j[3 * a + i] * v[a];
      }
    }
    for (int i = 0; i < 3; ++i) push[3 * node + i] = sum[i];
  }
};

/// One index = one contact: D_b^-1 J z of its sides, the next vector.
struct SideVectorBody {
  TouchingNodes of;
  View<const double> node_velocity, side_diagonal;
  View<double> vector;  ///< out

  TETWARP_HD void operator()(std::int64_t contact) const {
    for (int side = 0; side < 2; ++side) {
      double u[3] = {0, 0, 0};
      of.add_velocity(contact, side, node_velocity.data, u);
      for (int a = 0; a < 3; ++a) {
        const std::int64_t place = 6 * contact + 3 * side + a;
        vector[place] = side_diagonal[place] > 0 ? u[a] / side_diagonal[place] : 0;
      }
    }
  }
};

/// One index = one body: lambda_b from two steps of the power iteration. With pushes q = J^T v and
/// v = D_b^-1 J z, z the velocities before, it is about q . C q / q . z; it is at most the number
/// of contacts.
struct BodyScaleBody {
  static constexpr double margin = 1.1;  ///< the estimate grows towards lambda_b

  CompliantBodies of;
  View<const double> push, before, after;  ///< q, z, C q, [nodes][3]
  View<double> scale;                      ///< out, [bodies]

  TETWARP_HD void operator()(std::int64_t body) const {
    const CompliantBody& own = of.bodies[body];
    double above = 0, below = 0;
    const std::int64_t begin = 3 * std::int64_t{own.first_node};
    for (std::int64_t i = begin; i < begin + 3 * std::int64_t{own.node_count}; ++i) {
      above += push[i] * after[i];
      below += push[i] * before[i];
    }
    const double most = own.contact_count;
    scale[body] = above < most * below ? max_of(min_of(margin * above / below, most), 1.0) : most;
  }
};

/// One index = one contact: its constants with the majorant for its own block.
struct MajorantBody {
  TouchingNodes of;
  View<const ContactConstants<double>> constants;
  View<const double> side_diagonal, scale;
  View<ContactConstants<double>> majorant;  ///< out

  TETWARP_HD void operator()(std::int64_t contact) const {
    ContactConstants<double> own = constants[contact];
    for (int e = 0; e < 9; ++e) own.block[e] = 0;
    for (int side = 0; side < 2; ++side) {
      const std::int32_t body = of.sides[2 * contact + side];
      if (body < 0) continue;
      for (int a = 0; a < 3; ++a) {
        own.block[4 * a] += scale[body] * side_diagonal[6 * contact + 3 * side + a];
      }
    }
    own.tangent_metric = max_of(own.block[4], own.block[8]);
    majorant[contact] = own;
  }
};

}  // namespace tetwarp
