/// @file contact_fill.hpp
/// Stage "setup" of the contact solver: copies the numbers of a problem from the order of the
/// problem to the order of the structure, which the other stages use.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/contact/contact_indices.hpp"
#include "kernels/contact/contact_numbers.hpp"
#include "kernels/contact/contact_setup.hpp"

namespace tetwarp {

/// The numbers of a problem in the problem's own order.
struct ContactInput {
  View<const double> matrix;          ///< stored numbers of W, or of A
  View<const double> jacobian;        ///< stored numbers of J
  View<const double> load;            ///< b, [dofs]
  View<const double> given_velocity;  ///< q, or w, [3 contacts]
  View<const double> friction;        ///< [contacts]

  bool has_adhesion = false;
  double time_step = 0;
  View<const double> area, stiffness, tangential_stiffness, intensity, gap;  ///< or empty

  /// Of blocks of rows that are not contacts, which follow the contacts; empty if there are none.
  View<const std::uint8_t> row_kind;     ///< ContactKind of these blocks, [contacts]
  View<const std::int32_t> row_contact;  ///< of rolling blocks: the contact that they belong to
  View<const double> torsion;            ///< of rolling blocks [m]

  TETWARP_HD ContactKind kind_of(std::int64_t c) const {
    return row_kind.size == 0 ? ContactKind::coulomb : static_cast<ContactKind>(row_kind[c]);
  }
};

/// Options of the stage.
struct ContactChoices {
  double relaxation = 0.5;    ///< omega, of coupled islands
  bool skips_springs = true;  ///< leaves out the springs of contacts with beta = 0
  bool skips_rows = true;     ///< leaves out the tangents of contacts with mu = 0 and kappa_t = 0
};

/// Output of the stage; see SystemMemory. Matrices are zero before.
template <class T>
struct SystemViews {
  View<ContactConstants<T>> constants;
  View<T> free_velocity, offset, load, jacobian, response, inverse, system, body_free, delassus;
};

/// One index = `run` stored numbers, each added at its target. If two numbers have the same target,
/// a single index adds all of them.
struct ScatterOp {
  View<const double> values;
  View<const std::int64_t> target;
  std::int64_t run;
  View<double> out;

  TETWARP_HD void operator()(std::int64_t i) const {
    for (std::int64_t e = i * run; e < (i + 1) * run; ++e) {
      if (target[e] >= 0) out[target[e]] += values[e];
    }
  }
};

/// One index = one slot: friction and springs of its contact, kappa = dt^2 area C beta^2; another
/// stage body sets its block. Returns how many rows and springs are left out.
struct ContactConstantsOp {
  ContactInput in;
  View<const std::int32_t> contact_of_slot;
  ContactChoices choices;
  View<ContactConstants<double>> constants;

  TETWARP_HD PlainSums<2> operator()(std::int64_t slot) const {
    const std::int64_t c = contact_of_slot[slot];
    PlainSums<2> left_out;
    ContactConstants<double> result = {};
    result.friction = in.friction[c];
    if (!is_contact(in.kind_of(c))) {
      result.kind = in.kind_of(c);
      result.tangent_offset[1] = in.torsion[c];
      constants[slot] = result;
      return left_out;
    }
    result.kind = ContactKind::coulomb;
    if (in.has_adhesion) {
      const double beta = in.intensity[c];
      const double normal = entry_of(in.stiffness, c);
      const double tangent =
          in.tangential_stiffness.size == 0 ? normal : in.tangential_stiffness[c];
      const double scale = in.time_step * in.time_step * entry_of(in.area, c) * beta * beta;
      result.normal_spring = scale * normal;
      result.tangent_spring = scale * tangent;
      if (in.gap.size > 0 && in.time_step > 0) {
        for (int a = 0; a < 2; ++a) {
          result.tangent_offset[a] = in.gap[3 * c + 1 + a] / in.time_step;
        }
      }
      if (beta == 0 && choices.skips_springs) {
        left_out.value[1] = 1;
      } else {
        result.kind = ContactKind::adhesive;
      }
    }
    if (result.friction == 0 && result.tangent_spring == 0 && choices.skips_rows) {
      result.kind = ContactKind::frictionless;
      left_out.value[0] = 2;
    }
    constants[slot] = result;
    return left_out;
  }

 private:
  TETWARP_HD static double entry_of(View<const double> values, std::int64_t i) {
    return values.size == 0 ? 0.0 : values[i];
  }
};

/// One index = one slot: stores it as the slot of its contact.
struct SlotOfContactOp {
  View<const std::int32_t> contact_of_slot;
  View<std::int32_t> slot_of_contact;

  TETWARP_HD void operator()(std::int64_t slot) const {
    slot_of_contact[contact_of_slot[slot]] = static_cast<std::int32_t>(slot);
  }
};

/// One index = one slot: how many slots the contact of a rolling block is away from it; see
/// row_law.hpp.
struct RollingLinkOp {
  ContactInput in;
  View<const std::int32_t> contact_of_slot;
  View<const std::int32_t> slot_of_contact;
  View<ContactConstants<double>> constants;

  TETWARP_HD void operator()(std::int64_t slot) const {
    if (constants[slot].kind != ContactKind::rolling) return;
    const std::int32_t contact = in.row_contact[contact_of_slot[slot]];
    constants[slot].tangent_offset[0] = static_cast<double>(slot_of_contact[contact] - slot);
  }
};

/// One index = one place: copies the `width` numbers of its item.
template <int width>
struct GatherOp {
  View<const std::int32_t> item;
  View<const double> in;
  View<double> out;

  TETWARP_HD void operator()(std::int64_t i) const {
    for (int k = 0; k < width; ++k) out[width * i + k] = in[width * std::int64_t{item[i]} + k];
  }
};

/// One index = one contact of a Delassus matrix: its diagonal block and tangential metric.
struct DelassusDiagonalOp {
  View<const double> delassus;
  View<const std::int64_t> diagonal;
  View<ContactConstants<double>> constants;

  TETWARP_HD void operator()(std::int64_t c) const {
    for (int e = 0; e < 9; ++e) constants[c].block[e] = delassus[9 * diagonal[c] + e];
    ContactMetricOp<double>{constants}(c);
  }
};

/// One index = one block of A: its inverse, and v_free = A^-1 b if A couples it to no other block.
struct BlockSetupOp {
  View<const std::int64_t> dof_start;
  View<const std::int64_t> diagonal_value;
  View<const std::int64_t> inverse_start;
  View<const std::uint8_t> is_coupled;
  View<const double> system;
  View<const double> load;
  View<double> inverse;
  View<double> body_free;

  TETWARP_HD void operator()(std::int64_t b) const {
    const std::int64_t first = inverse_start[b], size = inverse_start[b + 1] - first;
    for (std::int64_t e = 0; e < size; ++e) inverse[first + e] = system[diagonal_value[b] + e];
    BlockInvertOp<double>{dof_start, inverse_start, inverse}(b);
    for (std::int64_t d = dof_start[b]; d < dof_start[b + 1]; ++d) body_free[d] = 0;
    if (is_coupled[b] == 0) {
      BodyRelaxOp<double>{dof_start, inverse_start, inverse, 1.0, load, body_free}(b);
    }
  }
};

/// One index = one contact between bodies: its responses, its own block, q = J v_free + w.
struct ContactSetupOp {
  ContactResponseOp<double> response;   ///< with the relaxation of coupled islands
  View<const std::uint8_t> is_coupled;  ///< [blocks]
  BodiesView<double> bodies;
  View<const double> body_free;
  View<double> free_velocity;

  TETWARP_HD void operator()(std::int64_t c) const {
    const PairView& pairs = response.pairs;
    ContactResponseOp<double> own = response;
    // All blocks of a contact are in one island, so testing the first one suffices.
    if (is_coupled[pairs.block[pairs.pair_start[c]]] == 0) own.relaxation = 1;
    own(c);
    ContactMetricOp<double>{response.constants}(c);
    bodies.velocity_at(c, body_free.data, free_velocity.data + 3 * c);
  }
};

/// Counts of rows and springs that a system leaves out because they cannot change the result.
struct ContactSavings {
  std::int64_t rows = 0;     ///< tangential rows
  std::int64_t springs = 0;  ///< contacts whose springs are left out
};

/// Fills a system in float64.
/// @param exec     where to run
/// @param in       numbers of the problem, in memory of the executor
/// @param indices  of the structure of the problem, in memory of the executor
/// @param choices  options
/// @param out      numbers in the order of the structure; zero before
/// @return  what was left out
/// @pre  diagonal blocks of A are positive definite
///
/// Determinism: same bits on every back end with contraction off. Cost: every number once, blocks
/// size^3.
template <class Exec>
ContactSavings fill_numbers(Exec& exec,
                            const ContactInput& in,
                            const ContactIndices& indices,
                            const ContactChoices& choices,
                            const SystemViews<double>& out) {
  constexpr const char* label = "contact/setup";
  const auto scatter = [&](View<const double> values, View<const std::int64_t> target,
                           bool is_unique, View<double> to) {
    const std::int64_t runs = is_unique ? values.size : std::int64_t{values.size > 0};
    exec.for_each(label, runs, ScatterOp{values, target, is_unique ? 1 : values.size, to});
  };
  const std::int64_t slots = indices.slots();
  const ContactConstantsOp constants = {in, indices.contact_of_slot, choices, out.constants};
  const auto left_out = exec.template sum<PlainSums<2>>(label, 0, slots, constants);
  if (in.row_kind.size > 0) {
    typename Exec::template Vector<std::int32_t> places;
    exec.make_zeros(places, slots);
    exec.for_each(label, slots, SlotOfContactOp{indices.contact_of_slot, view_of(places)});
    exec.for_each(label, slots,
                  RollingLinkOp{in, indices.contact_of_slot,
                                View<const std::int32_t>(view_of(places)), out.constants});
  }
  exec.for_each(label, slots,
                GatherOp<3>{indices.contact_of_slot, in.given_velocity,
                            indices.is_local ? out.free_velocity : out.offset});
  if (indices.is_local) {
    if (indices.delassus_target.size == 0) {
      exec.copy(label, in.matrix, out.delassus);
    } else {
      scatter(in.matrix, indices.delassus_target, indices.matrix_is_unique, out.delassus);
    }
    exec.for_each(label, slots,
                  DelassusDiagonalOp{out.delassus, indices.delassus_diagonal, out.constants});
  } else {
    const View<const std::int64_t> dof_start = indices.pairs.dof_start;
    scatter(in.matrix, indices.system_target, indices.matrix_is_unique, out.system);
    scatter(in.jacobian, indices.jacobian_target, indices.jacobian_is_unique, out.jacobian);
    exec.for_each(label, indices.dofs(), GatherOp<1>{indices.dof_of_place, in.load, out.load});
    exec.for_each(
        label, indices.blocks(),
        BlockSetupOp{dof_start, indices.diagonal_value, indices.inverse_start,
                     indices.block_is_coupled, out.system, out.load, out.inverse, out.body_free});
    exec.for_each(label, slots,
                  ContactSetupOp{{indices.pairs, out.jacobian, indices.inverse_start, out.inverse,
                                  choices.relaxation, out.response, out.constants},
                                 indices.block_is_coupled,
                                 {indices.pairs, out.jacobian, out.response, out.offset},
                                 out.body_free,
                                 out.free_velocity});
  }
  return {static_cast<std::int64_t>(left_out.value[0]),
          static_cast<std::int64_t>(left_out.value[1])};
}

/// One index = one contact: its constants in another precision.
template <class To, class From>
struct ConvertConstantsOp {
  View<const ContactConstants<From>> in;
  View<ContactConstants<To>> out;

  TETWARP_HD void operator()(std::int64_t i) const {
    const ContactConstants<From>& c = in[i];
    ContactConstants<To> result = {};
    for (int e = 0; e < 9; ++e) result.block[e] = static_cast<To>(c.block[e]);
    result.tangent_metric = static_cast<To>(c.tangent_metric);
    result.friction = static_cast<To>(c.friction);
    result.normal_spring = static_cast<To>(c.normal_spring);
    result.tangent_spring = static_cast<To>(c.tangent_spring);
    for (int a = 0; a < 2; ++a) result.tangent_offset[a] = static_cast<To>(c.tangent_offset[a]);
    result.kind = c.kind;
    out[i] = result;
  }
};

}  // namespace tetwarp
