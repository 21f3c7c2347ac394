/// @file two_level_numbers.cuh
/// TwoLevelNumbers: contacts between compliant bodies and how they act, in memory of a device.
#pragma once
#include <cstdint>
#include <tuple>
#include <vector>

#include "host/simulate/solve/two_level/resident_two_level.hpp"
#include "host/simulate/step/body_arrays.hpp"
#include "host/simulate/step/cuda/compliance_store.cuh"
#include "host/simulate/step/cuda/touching_lists.cuh"
#include "kernels/contact/compliant_gradients.hpp"
#include "kernels/contact/row_start.hpp"

namespace tetwarp {

/// What a solve needs besides its iterates; of it only damping and majorants change on the way.
class TwoLevelNumbers {
 public:
  /// @param node_count, rigid_count  of the model
  TwoLevelNumbers(std::int64_t node_count, std::int64_t rigid_count)
      : node_count_(node_count), rigid_count_(rigid_count) {}

  /// Copies bodies, contacts and laws to the device, makes the lists of contacts, and takes the
  /// numbers of the system there.
  /// @param rows    of the system, in memory of the device
  /// @param arrays  of the step
  void set(CudaExec& exec,
           const SystemRows& rows,
           const StepArrays<CudaExec>& arrays,
           View<const SurfacePoint> points,
           const CompliantLists& lists,
           const TwoLevelStart& start,
           RestFactors& factors) {
    host_bodies_ = lists.bodies;
    store_.set_inverses(exec, factors, start.time_step, lists.model_body, host_bodies_);
    lists_.set_bodies(exec, lists, host_bodies_);
    upload(exec, start);
    lists_.make(exec, {points, exec.view(arrays.center), static_cast<std::int32_t>(node_count_)},
                contacts_);
    lists_.set(touching_);
    rows_ = rows;
    values_ = exec.view(arrays.values);
    load_ = exec.view(arrays.load);
    CompliantBodies& bodies = touching_.bodies;
    const std::int64_t blocks = touching_.rows.row.size, numbers = 3 * lists.row_count();
    turned_.resize(9 * blocks);
    inverse_.resize(9 * std::int64_t{rows.unknown_count} + 36 * rigid_count_);
    start_velocity_.resize(numbers);
    weight_.resize(numbers);
    bodies.diagonal = {rows.pair, rows.block_of, rows.unknown_count, node_count_, inverse_.view()};
    exec.for_each(label, lists_.diagonal_rows().size,
                  DiagonalInvertOp{lists_.diagonal_rows(), {rows, values_, bodies.diagonal}});
    exec.for_each(label, blocks, TurnJacobianOp{bodies, touching_.rows, turned_.view()});
    touching_.turned = const_view(turned_);
    exec.for_each(label, numbers / 3,
                  RowStartOp{lists_.system_row(), rows, values_, exec.view(arrays.x),
                             start_velocity_.view(), weight_.view()});
  }

  /// Computes the compliance of the bodies, the blocks of the contacts and their majorants.
  /// @param damping  factor of the compliance of elastic bodies
  void set_damping(CudaExec& exec, double damping) {
    CompliantBodies& bodies = touching_.bodies;
    const std::int64_t contacts = laws_.size, parts = touching_.part_body.size;
    const std::int64_t nodes = bodies.row_of_node.size;
    bodies.damping = damping;
    compliance_.resize(9 * lists_.node_pairs());
    constants_.resize(contacts);
    majorant_.resize(contacts);
    part_diagonal_.resize(3 * parts);
    vector_.resize(3 * parts);
    scale_.resize(bodies.bodies.size);
    for (DeviceVector<double>* v : {&push_, &before_, &after_}) v->resize(3 * nodes);
    exec.for_each_item(label, lists_.pair_start(), lists_.node_pairs(),
                       ComplianceBlockOp{bodies, compliance_.view()});
    bodies.compliance = View<const float>(compliance_.view());
    exec.copy(label, laws_, constants_.view());
    set_majorants(exec, touching_,
                  {constants_.view(), majorant_.view(), scale_.view(), part_diagonal_.view(),
                   vector_.view(), push_.view(), before_.view(), after_.view()});
  }

  /// Doubles the majorants.
  void grow_majorants(CudaExec& exec) {
    exec.for_each(label, majorant_.view().size, MajorantGrowOp{majorant_.view()});
  }

  const TouchingNodes& touching() const { return touching_; }
  View<const ContactConstants<double>> constants() const { return constants_.view(); }
  View<const ContactConstants<double>> majorant() const { return majorant_.view(); }
  View<const double> start_velocity() const { return start_velocity_.view(); }  ///< [rows][3]
  View<const double> start_impulse() const { return start_impulse_; }           ///< [3 contacts]
  View<const double> preload() const { return preload_; }                       ///< [3 contacts]
  View<const double> change() const { return change_; }  ///< [rows][3], or empty
  View<const double> weight() const { return weight_.view(); }
  View<const std::int32_t> model_block() const { return lists_.model_block(); }

  /// b + J^T (impulse - preload) - A velocity, in frames.
  RowDefectOp defect(View<const double> velocity,
                     View<const double> impulse,
                     View<double> out) const {
    return {touching_.bodies, touching_.rows, rows_,    values_, load_,
            velocity,         impulse,        preload_, out};
  }
  /// The system of the step in frames, with vectors of conjugate gradients.
  CompliantGradients gradients(
      View<double> x, View<double> r, View<double> z, View<double> p, View<double> q) const {
    return {touching_.bodies, rows_, values_, x, r, z, p, q};
  }

 private:
  static constexpr const char* label = "body/contact";

  /// In one transfer.
  void upload(CudaExec& exec, const TwoLevelStart& start) {
    host_preload_.assign(3 * start.laws.preload.size(), 0.0);
    for (std::size_t c = 0; c < start.laws.preload.size(); ++c) {
      host_preload_[3 * c] = start.laws.preload[c];
    }
    std::tie(touching_.bodies.rotation, contacts_, laws_, touching_.rows.offset, start_impulse_,
             preload_, change_) =
        staged_.put(exec, start.rotation, start.contacts, start.laws.constants, start.offset,
                    start.impulse, host_preload_, start.change);
  }

  std::int64_t node_count_, rigid_count_;
  ComplianceStore store_;
  std::vector<CompliantBody> host_bodies_;
  std::vector<double> host_preload_;
  StagedArrays staged_;
  TouchingLists lists_;
  TouchingNodes touching_;
  SystemRows rows_;
  View<const double> values_, load_, start_impulse_, preload_, change_;
  View<const ContactSides> contacts_;
  View<const ContactConstants<double>> laws_;
  DeviceVector<double> turned_, inverse_, start_velocity_, weight_;
  DeviceVector<double> part_diagonal_, vector_, scale_;
  DeviceVector<double> push_, before_, after_;  ///< [nodes][3], of the power iteration
  DeviceVector<float> compliance_;
  DeviceVector<ContactConstants<double>> constants_, majorant_;
};

}  // namespace tetwarp
