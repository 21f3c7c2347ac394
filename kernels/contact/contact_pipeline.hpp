/// @file contact_pipeline.hpp
/// The stages by which the contact solver solves one island, for any executor: host threads, a
/// whole device, or one block of it. Read this file first: sweep() improves the impulses, measure()
/// returns their residual.
#pragma once
#include <cstdint>

#include "kernels/contact/body_relax.hpp"
#include "kernels/contact/contact_numbers.hpp"
#include "kernels/contact/contact_residual.hpp"
#include "kernels/contact/contact_sweep.hpp"
#include "kernels/contact/vector_bodies.hpp"

namespace tetwarp {

/// The stages of one island. "Current" impulses and velocities are those of the state.
template <class Exec, class T>
class ContactPipeline {
 public:
  /// @param exec         where to run; kept by the caller
  /// @param numbers      of the whole problem, in memory of the executor
  /// @param color_start  of all islands, in memory that the caller reads
  /// @param state        of the whole problem, in memory of the executor
  TETWARP_ANY_EXEC ContactPipeline(Exec& exec,
                                   const ContactNumbers<T>& numbers,
                                   View<const std::int64_t> color_start,
                                   const ContactIsland& island,
                                   ContactSwitches switches,
                                   const ContactState<T>& state)
      : exec_(exec),
        numbers_(numbers),
        color_start_(color_start),
        island_(island),
        switches_(switches),
        state_(state) {}

  TETWARP_HD Exec& exec() const { return exec_; }
  TETWARP_HD const ContactIsland& island() const { return island_; }
  TETWARP_HD const ContactState<T>& state() const { return state_; }

  /// r of the island's contacts.
  TETWARP_HD View<T> impulse() const {
    return {state_.impulse.data + 3 * island_.slot_begin, 3 * island_.contact_count()};
  }
  /// v of the island's dofs; empty in local form.
  TETWARP_HD View<T> body_velocity() const {
    return {state_.body_velocity.data + island_.dof_begin, island_.dof_end - island_.dof_begin};
  }
  TETWARP_HD View<const ContactConstants<T>> constants() const {
    return {numbers_.constants.data + island_.slot_begin, island_.contact_count()};
  }

  /// One pass over all contacts of the island.
  /// @param frozen  which of them it skips
  TETWARP_ANY_EXEC void sweep(const FrozenContacts<T>& frozen) {
    const View<const std::int64_t> colors = {color_start_.data + island_.color_begin,
                                             island_.color_end - island_.color_begin};
    if (numbers_.is_local) {
      contact_sweep(exec_, colors,
                    DelassusSweepOp<T>{numbers_.delassus, numbers_.constants, switches_, frozen,
                                       state_.impulse});
    } else {
      contact_sweep(exec_, colors,
                    BodySweepOp<T>{numbers_.bodies, numbers_.constants, switches_, frozen,
                                   state_.impulse, state_.body_velocity});
    }
  }

  /// Sets v to the velocities of r; required after r was changed by anything but a sweep.
  /// @pre A does not couple the island's blocks
  TETWARP_ANY_EXEC void follow_impulses() {
    if (numbers_.is_local) return;
    body_relax(exec_, island_.block_begin, island_.block_end,
               BodyVelocityOp<T>{numbers_.block_contacts, numbers_.bodies.pairs.dof_start,
                                 numbers_.bodies.response, state_.impulse, numbers_.body_free,
                                 state_.body_velocity});
  }

  /// Replaces the current body velocities by another vector, [dofs] of the whole problem.
  TETWARP_HD void use_body_velocity(View<T> body_velocity) { state_.body_velocity = body_velocity; }

  /// A block-Jacobi step with the current impulses: v = x + omega D^-1 (b + J^T r - A x).
  /// @param x  [dofs] of the whole problem; not the memory of v
  TETWARP_ANY_EXEC void step_bodies(View<const T> x, T relaxation) {
    body_relax(exec_, island_.block_begin, island_.block_end,
               BodyStepOp<T>{{numbers_.system, numbers_.block_contacts, numbers_.bodies.jacobian,
                              numbers_.load, state_.impulse, x, state_.defect},
                             numbers_.inverse_start,
                             numbers_.inverse,
                             relaxation,
                             state_.body_velocity});
  }

  /// Sets u to J v + w. @param v  [dofs] of the whole problem; in local form not read
  TETWARP_ANY_EXEC void find_velocities(View<const T> v) {
    const std::int64_t first = island_.slot_begin, count = island_.contact_count();
    if (numbers_.is_local) {
      contact_velocities(exec_, first, count,
                         ContactVelocityOp<DelassusView<T>, T>{
                             numbers_.delassus, state_.impulse.data, state_.velocity});
    } else {
      contact_velocities(
          exec_, first, count,
          ContactVelocityOp<BodiesView<T>, T>{numbers_.bodies, v.data, state_.velocity});
    }
  }

  /// Residual of the current r and v. Unless `is_final`, ContactSums::magnitude stays 0 where its
  /// bound shows that rounding of the work does not matter.
  TETWARP_ANY_EXEC ContactSums measure(bool is_final = false) {
    constexpr double cancellation = 0x1p25;
    find_velocities(state_.body_velocity);
    ContactSums sums =
        contact_residual(exec_, island_.slot_begin, island_.slot_end,
                         ContactResidualOp<T>{numbers_.constants, switches_, state_.impulse,
                                              state_.velocity, numbers_.free_velocity});
    const auto rows = 3 * static_cast<double>(island_.slot_end - island_.slot_begin);
    const bool is_needed =
        is_final ? sums.row_work > 0 : rows * sums.row_work > cancellation * sums.work;
    if (is_needed) sums.magnitude = magnitude();
    return sums;
  }

  /// |r| . |B| |r| of the current r; see ContactSums. In coupled islands B is omega J D^-1 J^T,
  /// with D the diagonal blocks of A and omega the relaxation.
  TETWARP_ANY_EXEC double magnitude() {
    if (numbers_.is_local) {
      return exec_
          .template sum<PlainSums<1>>("contact/residual", island_.slot_begin, island_.slot_end,
                                      DelassusMagnitudeOp<T>{numbers_.delassus, state_.impulse})
          .value[0];
    }
    return exec_
        .template sum<PlainSums<1>>(
            "contact/residual", island_.block_begin, island_.block_end,
            BodyMagnitudeOp<T>{numbers_.block_contacts, numbers_.bodies.pairs.dof_start,
                               numbers_.bodies.jacobian, numbers_.bodies.response, state_.impulse})
        .value[0];
  }

  /// |q|^2 of the island.
  TETWARP_ANY_EXEC double free_square() {
    return exec_
        .template sum<PlainSums<1>>("contact/residual", 3 * island_.slot_begin,
                                    3 * island_.slot_end, SquareOp<T>{numbers_.free_velocity})
        .value[0];
  }

 private:
  Exec& exec_;
  ContactNumbers<T> numbers_;
  View<const std::int64_t> color_start_;
  ContactIsland island_;
  ContactSwitches switches_;
  ContactState<T> state_;
};

}  // namespace tetwarp
