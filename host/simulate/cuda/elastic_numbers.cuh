/// @file elastic_numbers.cuh
/// ElasticNumbers: contacts between compliant bodies and how they act, in memory of a device.
#pragma once
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "host/simulate/body_arrays.hpp"
#include "host/simulate/cuda/compliance_store.cuh"
#include "host/simulate/resident_elastic.hpp"
#include "kernels/contact/contact_grid.cuh"
#include "kernels/elastic/elastic_start.hpp"
#include "kernels/elastic/group_sweep.cuh"
#include "kernels/exec/staged_arrays.cuh"

namespace tetwarp {

/// What does not change during a solve, but for the damping.
class ElasticNumbers {
 public:
  /// @param node_count, rigid_count  of the model
  ElasticNumbers(std::int64_t node_count, std::int64_t rigid_count)
      : node_count_(node_count), rigid_count_(rigid_count) {}

  /// Copies lists and laws to the device by one call, and takes the numbers of the system there.
  /// @param rows    of the system, in memory of the device
  /// @param arrays  of the step
  void set(CudaStepExec& exec,
           GridContactExec& grid,
           const SystemRows& rows,
           const StepArrays<CudaStepExec>& arrays,
           const ElasticLists& lists,
           const ElasticStart& start,
           RestFactors& factors) {
    std::vector<CompliantBody>& with_inverses = host_bodies_;
    with_inverses = lists.bodies;
    store_.set_inverses(exec, factors, start.time_step, lists.model_body, with_inverses);
    host_preload_.assign(3 * lists.contacts.size(), 0.0);
    for (std::size_t c = 0; c < lists.contacts.size(); ++c) {
      host_preload_[3 * c] = start.laws.preload[c];
    }
    TouchingRows& touching = groups_.touching;
    CompliantBodies& bodies = groups_.bodies;
    View<const double> axes;
    View<const ContactArm> arms;
    View<const ArmPlace> places;
    View<const std::int32_t> rigid_rows;
    View<const ContactConstants<double>> laws;
    std::tie(bodies.bodies, bodies.body_of_row, bodies.row_of_node, system_row_, model_block_,
             rigid_rows) = bodies_.put(grid, with_inverses, lists.body_of_row, lists.row_of_node,
                                       lists.system_row, lists.model_block, lists.rigid_rows);
    std::tie(touching.block_start, touching.row, touching.node, touching.contact,
             touching.touch_start, touching.touch, axes, arms, places) =
        blocks_.put(grid, lists.block_start, lists.block_row, lists.block_node, lists.block_contact,
                    lists.touch_start, lists.touch, lists.axes, lists.arms, lists.places);
    std::tie(groups_.groups, groups_.group_of_contact, unit_start_, matrix_start_, laws,
             touching.offset, start_impulse_, preload_, change_) =
        laws_.put(grid, lists.groups, lists.group_of_contact, lists.unit_start, lists.matrix_start,
                  start.laws.constants, start.offset, start.impulse, host_preload_, start.change);
    rows_ = rows;
    values_ = exec.view(arrays.values);
    load_ = exec.view(arrays.load);
    const std::int64_t blocks = touching.row.size, numbers = 3 * bodies.body_of_row.size;
    jacobian_.resize(9 * blocks);
    turned_.resize(9 * blocks);
    units_.resize(lists.unit_count);
    matrix_.resize(lists.matrix_count);
    constants_.resize(laws.size);
    diagonal_.resize(3 * laws.size);
    inverse_.resize(9 * std::int64_t{rows.unknown_count} + 36 * rigid_count_);
    start_velocity_.resize(numbers);
    weight_.resize(numbers);
    grid.copy(label, laws, constants_.view());
    bodies.diagonal = {rows.pair, rows.block_of, rows.unknown_count, node_count_, inverse_.view()};
    grid.for_each(label, rigid_rows.size,
                  RigidInvertBody{rigid_rows, {rows, values_, bodies.diagonal}});
    grid.for_each(label, places.size, ContactRowsBody{axes, arms, places, jacobian_.view()});
    touching.jacobian = const_view(jacobian_);
    grid.for_each(label, blocks, TurnJacobianBody{bodies, touching, turned_.view()});
    groups_.turned = const_view(turned_);
    grid.for_each(label, numbers / 3,
                  RowStartBody{system_row_, rows, values_, exec.view(arrays.x),
                               start_velocity_.view(), weight_.view()});
  }

  /// Computes how the impulses of a group act.
  /// @param damping  factor of the compliance of elastic bodies
  void set_damping(CudaStepExec& exec, GridContactExec& grid, double damping) {
    groups_.bodies.damping = damping;
    CudaExec& device = exec.device_exec();
    device.for_each_item(label, unit_start_, pairs_of(units_, 9),
                         UnitVelocityBody{groups_, units_.view()});
    device.for_each_item(label, matrix_start_, pairs_of(matrix_, 9),
                         GroupMatrixBody{groups_, const_view(units_), matrix_.view()});
    grid.for_each(label, constants_.view().size,
                  OwnBlockBody{groups_, const_view(matrix_), constants_.view(), diagonal_.view()});
  }

  const ContactGroups& groups() const { return groups_; }
  View<const ContactConstants<double>> constants() const { return constants_.view(); }
  View<const float> units() const { return units_.view(); }
  View<const float> matrix() const { return matrix_.view(); }
  View<const double> diagonal() const { return diagonal_.view(); }
  View<const double> start_velocity() const { return start_velocity_.view(); }
  View<const double> start_impulse() const { return start_impulse_; }
  View<const double> preload() const { return preload_; }  ///< [3 contacts]
  View<const double> change() const { return change_; }
  View<const double> weight() const { return weight_.view(); }
  View<const std::int32_t> model_block() const { return model_block_; }

  /// b + J^T (impulse - preload) - A velocity, in frames.
  RowDefectBody defect(View<const double> velocity,
                       View<const double> impulse,
                       View<double> out) const {
    return {groups_.bodies, groups_.touching, rows_,    values_, load_,
            velocity,       impulse,          preload_, out};
  }

 private:
  static constexpr const char* label = "body/contact";

  template <class T>
  static View<const T> const_view(const DeviceVector<T>& values) {
    return values.view();
  }
  template <class T>
  static std::int64_t pairs_of(const DeviceVector<T>& values, std::int64_t width) {
    return values.view().size / width;
  }

  std::int64_t node_count_, rigid_count_;
  ComplianceStore store_;
  std::vector<CompliantBody> host_bodies_;
  std::vector<double> host_preload_;
  StagedArrays bodies_, blocks_, laws_;
  ContactGroups groups_;
  SystemRows rows_;
  View<const double> values_, load_, start_impulse_, preload_, change_;
  View<const std::int32_t> system_row_, model_block_;
  View<const std::int64_t> unit_start_, matrix_start_;
  DeviceVector<double> jacobian_, turned_, inverse_, diagonal_, start_velocity_, weight_;
  DeviceVector<float> units_, matrix_;
  DeviceVector<ContactConstants<double>> constants_;
};

}  // namespace tetwarp
