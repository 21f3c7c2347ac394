/// @file resident_contacts_cuda.cuh
/// ResidentContacts on a device: contacts and laws are copied there together, kernels compute A, J
/// and b, and all results are copied back together.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/simulate/step/body_pipeline.hpp"
#include "host/simulate/step/resident_contacts.hpp"

namespace tetwarp {

template <class T>
class CudaResidentContacts final : public ResidentContacts {
 public:
  /// @param exec, pipeline  kept by the caller
  CudaResidentContacts(CudaExec& exec, BodyPipeline<CudaExec, T>& pipeline)
      : exec_(exec), pipeline_(pipeline) {}

  SystemRows rows() override { return pipeline_.host_rows(); }

  void set_places(const ProblemPlaces& places) override {
    const DeviceScope scope = exec_.enter();
    exec_.put(places.blocks, blocks_);
    exec_.put(places.rows, rows_);
    exec_.put(places.model_block, model_block_);
    exec_.put(places.arms, arm_places_);
    system_.resize(places.system_size);
    jacobian_.resize(places.jacobian_size);
    load_.resize(3 * count_of(places.rows));
  }

  ResidentStepProblem set_contacts(const ProblemArms& contacts,
                                   const ContactProblem& laws) override {
    const DeviceScope scope = exec_.enter();
    const AdhesionState& adhesion = laws.adhesion;
    ResidentStepProblem problem;
    ContactArrays& of = problem.arrays;
    std::span<const double> axes, arms;
    const View<const double> arm_numbers = numbers_of(contacts.arms);
    const std::pair<std::span<const double>, std::span<const double>*> all[] = {
        {contacts.axes, &axes},
        {{arm_numbers.data, static_cast<std::size_t>(arm_numbers.size)}, &arms},
        {laws.friction, &of.friction},
        {laws.velocity_offset, &of.velocity_offset},
        {laws.impulse_guess, &of.impulse_guess},
        {adhesion.area, &of.area},
        {adhesion.stiffness, &of.stiffness},
        {adhesion.tangential_stiffness, &of.tangential_stiffness},
        {adhesion.intensity, &of.intensity},
        {adhesion.gap, &of.gap}};
    staged_.clear();
    for (const auto& [from, to] : all) staged_.insert(staged_.end(), from.begin(), from.end());
    exec_.put(staged_, given_);
    const double* next = given_.view().data;
    for (const auto& [from, to] : all) {
      *to = {next, from.size()};
      next += from.size();
    }
    const std::int64_t arm_count = count_of(contacts.arms);
    exec_.for_each(label, arm_count,
                   ContactRowsOp{{axes.data(), static_cast<std::int64_t>(axes.size())},
                                 {reinterpret_cast<const ContactArm*>(arms.data()), arm_count},
                                 view(arm_places_),
                                 jacobian_.view()});
    const StepArrays<CudaExec>& now = pipeline_.arrays();
    exec_.for_each(label, view(blocks_).size,
                   SystemGatherOp{view(blocks_), view(now.values), system_.view()});
    exec_.for_each(label, view(rows_).size,
                   GatherThreeOp{view(rows_), view(now.load), load_.view()});
    contact_numbers_ = 3 * count_of(laws.friction);
    results_.resize(2 * contact_numbers_ + view(load_).size);
    of.system = span_of(view(system_));
    of.jacobian = span_of(view(jacobian_));
    of.load = span_of(view(load_));
    of.time_step = adhesion.time_step;
    of.memory = problem.target.memory = Memory::device;
    problem.target.impulse = span_of(part(results_.view(), 0, contact_numbers_));
    problem.target.velocity = span_of(part(results_.view(), contact_numbers_, contact_numbers_));
    problem.target.body_velocity = span_of(body_velocity(results_.view()));
    problem.target.stream = exec_.stream();
    return problem;
  }

  ResidentResults results() override {
    const DeviceScope scope = exec_.enter();
    host_results_.resize(static_cast<std::size_t>(view(results_).size));
    exec_.get(view(results_), host_results_.data());
    const View<const double> all = {host_results_.data(), count_of(host_results_)};
    return {span_of(part(all, 0, contact_numbers_)),
            span_of(part(all, contact_numbers_, contact_numbers_)), span_of(body_velocity(all))};
  }

  void set_velocities() override {
    const DeviceScope scope = exec_.enter();
    exec_.for_each(label, view(model_block_).size,
                   ScatterThreeOp{view(model_block_), body_velocity(view(results_)),
                                  pipeline_.arrays().velocity.view()});
  }

 private:
  static constexpr const char* label = "body/contact";

  template <class Value>
  static View<const Value> view(const DeviceVector<Value>& values) {
    return values.view();
  }
  template <class Value>
  static std::span<Value> span_of(View<Value> values) {
    return {values.data, static_cast<std::size_t>(values.size)};
  }
  template <class Value>
  static View<Value> part(View<Value> all, std::int64_t first, std::int64_t size) {
    return {all.data + first, size};
  }
  template <class Value>
  View<Value> body_velocity(View<Value> all) const {
    return part(all, 2 * contact_numbers_, all.size - 2 * contact_numbers_);
  }
  CudaExec& exec_;
  BodyPipeline<CudaExec, T>& pipeline_;
  DeviceVector<SystemBlockPlace> blocks_;
  DeviceVector<std::int32_t> rows_, model_block_;
  DeviceVector<ArmPlace> arm_places_;
  DeviceVector<double> given_;  ///< what the host has sent
  DeviceVector<double> system_, jacobian_, load_;
  std::int64_t contact_numbers_ = 0;  ///< 3 per contact
  DeviceVector<double> results_;      ///< impulses, velocities of contacts, of dofs
  std::vector<double> staged_, host_results_;
};

}  // namespace tetwarp
