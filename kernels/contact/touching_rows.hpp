/// @file touching_rows.hpp
/// Contacts on the rows of compliant bodies: their velocities, and J^T times their impulses.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/contact/compliant_body.hpp"
#include "kernels/contact/contact_residual.hpp"

namespace tetwarp {

/// J of the contacts in 3x3 blocks, row by row: velocities along the axes of a contact per velocity
/// of a row. The blocks of a contact on one body follow each other and are called a part of the
/// contact.
struct TouchingRows {
  View<const std::int32_t> block_start;               ///< [contacts + 1]
  View<const std::int32_t> row, node, contact, part;  ///< [blocks]
  View<const double> jacobian;                        ///< [blocks][9]
  View<const std::int32_t> touch_start, touch;        ///< of each row its blocks, ascending
  View<const double> offset;                          ///< w, [3 contacts]

  /// force += J^T (impulse - minus) of every 32nd contact on a row.
  /// @param minus  [3 contacts]
  TETWARP_HD void add_forces(std::int64_t of_row,
                             int lane,
                             const double* impulse,
                             const double* minus,
                             double* force) const {
    for (std::int64_t t = touch_start[of_row] + lane; t < touch_start[of_row + 1]; t += 32) {
      const std::int64_t block = touch[t];
      const std::int64_t first = 3 * std::int64_t{contact[block]};
      const double* const j = jacobian.data + 9 * block;
      for (int a = 0; a < 3; ++a) {
        const double r = impulse[first + a] - minus[first + a];
        for (int i = 0; i < 3; ++i) force[i] += j[3 * a + i] * r;
      }
    }
  }
};

/// One index = one row: b + J^T (r - preload) - A v, in frames. By lanes.
struct RowDefectOp {
  using Sum = PlainSums<3>;
  static constexpr int lanes = 32;

  CompliantBodies of;
  TouchingRows touching;
  SystemRows rows;
  View<const double> values, load;      ///< of the system
  View<const double> velocity;          ///< v, [rows][3]
  View<const double> impulse, preload;  ///< [3 contacts]
  View<double> defect;                  ///< out

  TETWARP_HD Sum part(std::int64_t row, int lane) const {
    const CompliantBody& own = of.of_row(row);
    const std::int64_t place = own.system_row + row - own.first;
    // Columns of the system are rows of the same coupling island, all of which are in the solve.
    const double* const from = velocity.data + 3 * (own.first - std::int64_t{own.system_row});
    Sum force;
    for (std::int64_t k = rows.start[place] + lane; k < rows.free_end[place]; k += lanes) {
      double product[3];
      multiply_blocks(values.data, rows.column.data, k, k + 1, from, product);
      for (int i = 0; i < 3; ++i) force.value[i] -= product[i];
    }
    touching.add_forces(row, lane, impulse.data, preload.data, force.value);
    return force;
  }
  TETWARP_HD void finish(std::int64_t row, const Sum& sum) const {
    const CompliantBody& own = of.of_row(row);
    const std::int64_t place = own.system_row + row - own.first;
    double force[3];
    for (int i = 0; i < 3; ++i) force[i] = load[3 * place + i] + sum.value[i];
    of.to_frame(own, force, defect.data + 3 * row);
  }
};

/// One index = one row: J^T (after - before), in frames. By lanes: hundreds of contacts may act on
/// one row, that of a rigid body.
struct RowPushOp {
  using Sum = PlainSums<3>;
  static constexpr int lanes = 32;

  CompliantBodies of;
  TouchingRows touching;
  View<const double> after, before;  ///< [3 contacts]
  View<double> push;                 ///< out

  TETWARP_HD Sum part(std::int64_t row, int lane) const {
    Sum force;
    touching.add_forces(row, lane, after.data, before.data, force.value);
    return force;
  }
  TETWARP_HD void finish(std::int64_t row, const Sum& force) const {
    of.to_frame(of.of_row(row), force.value, push.data + 3 * row);
  }
};

/// One index = one contact: u = J v + w.
struct TouchVelocityOp {
  TouchingRows touching;
  View<const double> velocity;    ///< v, [rows][3]
  View<double> contact_velocity;  ///< out, [3 contacts]

  TETWARP_HD void operator()(std::int64_t contact) const {
    double u[3] = {touching.offset[3 * contact], touching.offset[3 * contact + 1],
                   touching.offset[3 * contact + 2]};
    for (std::int64_t b = touching.block_start[contact]; b < touching.block_start[contact + 1];
         ++b) {
      const double* const j = touching.jacobian.data + 9 * b;
      const double* const v = velocity.data + 3 * std::int64_t{touching.row[b]};
      for (int a = 0; a < 3; ++a) {
        u[a] += j[3 * a] * v[0] + j[3 * a + 1] * v[1] + j[3 * a + 2] * v[2];
      }
    }
    for (int a = 0; a < 3; ++a) contact_velocity[3 * contact + a] = u[a];
  }
};

/// One index = one number: its term of d . M^-1 d.
struct DefectSquareOp {
  View<const double> defect, moved;  ///< d and M^-1 d

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const { return {{defect[i] * moved[i]}}; }
};

/// One index = one contact: eta_square(), and r . (u - u without impulses).
struct TouchErrorOp {
  View<const ContactConstants<double>> constants;
  ContactSwitches switches;
  View<const double> impulse, velocity, free_velocity;  ///< [3 contacts]

  TETWARP_HD PlainSums<2> operator()(std::int64_t contact) const {
    const ContactConstants<double>& own = constants[contact];
    const double* const r = impulse.data + 3 * contact;
    const double* const u = velocity.data + 3 * contact;
    PlainSums<2> sums;
    sums.value[0] = eta_square(own, switches, r, u);
    for (int a = 0; a < 3; ++a) sums.value[1] += r[a] * (u[a] - free_velocity[3 * contact + a]);
    return sums;
  }
};

}  // namespace tetwarp
