/// @file contact_pipeline.hpp
/// The contact solver of one island as a list of stages, for any executor. Read this file first:
/// sweep() is the method, measure() what it is judged by.
#pragma once
#include <cstdint>
#include <vector>

#include "host/contact_structure.hpp"
#include "host/contact_system.hpp"
#include "kernels/body_relax.hpp"
#include "kernels/contact_residual.hpp"
#include "kernels/contact_split.hpp"
#include "kernels/contact_sweep.hpp"

namespace tetwarp {

/// What a solve changes, for all islands together.
template <class T>
struct ContactState {
  std::vector<T> impulse;              ///< r, [3 slots]
  std::vector<T> velocity;             ///< u, [3 slots]
  std::vector<T> body_velocity;        ///< v, [dofs]
  std::vector<T> defect;               ///< b + J^T r - A v, [dofs], of coupled islands
  std::vector<std::uint8_t> calm;      ///< [slots], or empty where no contact may be frozen
  std::vector<std::int32_t> left_out;  ///< [slots]
};

template <class Exec, class T>
class ContactPipeline {
 public:
  ContactPipeline(Exec& exec,
                  const ContactStructure& structure,
                  const ContactSystem<T>& system,
                  const ContactIsland& island,
                  ContactSwitches switches,
                  ContactState<T>& state)
      : exec_(exec),
        structure_(structure),
        system_(system),
        island_(island),
        switches_(switches),
        state_(state) {}

  Exec& exec() const { return exec_; }
  const ContactIsland& island() const { return island_; }

  /// r of the island's contacts.
  View<T> impulse() const {
    return part(state_.impulse, 3 * island_.slot_begin, 3 * island_.slot_end);
  }
  /// v of the island's dofs; empty in local form.
  View<T> body_velocity() const {
    return part(state_.body_velocity, island_.dof_begin, island_.dof_end);
  }
  View<const ContactConstants<T>> constants() const {
    return {system_.constants.data() + island_.slot_begin, island_.contact_count()};
  }

  /// One pass over all contacts.
  void sweep(const CalmContacts<T>& calm) {
    const View<const std::int64_t> colors = {structure_.color_start.data() + island_.color_begin,
                                             island_.color_end - island_.color_begin};
    if (structure_.is_local) {
      contact_sweep(
          exec_, colors,
          DelassusSweepBody<T>{system_.delassus_view(structure_), view_of(system_.constants),
                               switches_, calm, view_of(state_.impulse)});
    } else {
      contact_sweep(
          exec_, colors,
          BodySweepBody<T>{system_.bodies_view(structure_), view_of(system_.constants), switches_,
                           calm, view_of(state_.impulse), view_of(state_.body_velocity)});
    }
  }

  /// The contacts' constants with the metric of split masses for their own blocks.
  std::vector<ContactConstants<T>> split_metric() {
    std::vector<ContactConstants<T>> metric(system_.constants.begin(), system_.constants.end());
    if (structure_.is_local) {
      run_contacts(DelassusSplitMetricBody<T>{system_.delassus_view(structure_), view_of(metric)});
    } else {
      run_contacts(BodySplitMetricBody<T>{system_.bodies_view(structure_),
                                          view_of(structure_.block_start), view_of(metric)});
    }
    run_contacts(ContactMetricBody<T>{view_of(metric)});
    return metric;
  }

  /// Every contact's answer to the same velocities, in the metric from above.
  void split(View<const ContactConstants<T>> metric) {
    find_velocities();
    run_contacts(
        ContactSplitBody<T>{metric, switches_, view_of(state_.velocity), view_of(state_.impulse)});
  }

  /// v from r, after r was changed by other means than a sweep.
  /// @pre A does not couple the island's blocks
  void follow_impulses() {
    if (structure_.is_local) return;
    body_relax(exec_, island_.block_begin, island_.block_end,
               BodyVelocityBody<T>{structure_.block_contacts(), view_of(structure_.dof_start),
                                   view_of(system_.response), view_of(state_.impulse),
                                   view_of(system_.body_free), view_of(state_.body_velocity)});
  }

  /// A step of block-Jacobi with the impulses at hand: v = x + omega D^-1 (b + J^T r - A x).
  /// @param x  [dofs] of the whole problem
  void step_bodies(const std::vector<T>& x, T relaxation) {
    body_relax(
        exec_, island_.block_begin, island_.block_end,
        BodyStepBody<T>{{structure_.system(view_of(system_.system)), structure_.block_contacts(),
                         view_of(system_.jacobian), view_of(system_.load), view_of(state_.impulse),
                         view_of(x), view_of(state_.defect)},
                        view_of(structure_.inverse_start),
                        view_of(system_.inverse),
                        relaxation,
                        view_of(state_.body_velocity)});
  }

  /// How far r and v are from the law.
  ContactSums measure() {
    find_velocities();
    return contact_residual(
        exec_, island_.slot_begin, island_.slot_end,
        ContactResidualBody<T>{view_of(system_.constants), switches_, view_of(state_.impulse),
                               view_of(state_.velocity), view_of(system_.free_velocity)});
  }

 private:
  template <class Body>
  void run_contacts(const Body& body) {
    exec_.for_each("contact/sweep", island_.contact_count(),
                   FromContact<Body>{body, island_.slot_begin});
  }
  void find_velocities() {
    if (structure_.is_local) {
      run_contacts(ContactVelocityBody<DelassusView<T>, T>{
          system_.delassus_view(structure_), state_.impulse.data(), view_of(state_.velocity)});
    } else {
      run_contacts(ContactVelocityBody<BodiesView<T>, T>{
          system_.bodies_view(structure_), state_.body_velocity.data(), view_of(state_.velocity)});
    }
  }
  static View<T> part(std::vector<T>& values, std::int64_t first, std::int64_t last) {
    if (values.empty()) return {};
    return {values.data() + first, last - first};
  }

  Exec& exec_;
  const ContactStructure& structure_;
  const ContactSystem<T>& system_;
  const ContactIsland& island_;
  ContactSwitches switches_;
  ContactState<T>& state_;
};

}  // namespace tetwarp
