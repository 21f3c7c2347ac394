/// @file resident_state_cuda.cuh
/// ResidentState on a device. Between two records of a Simulator only a few sums per body and
/// coupling, and the places that scripts and pressures need, come to the host.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "host/simulate/step/body_pipeline.hpp"
#include "host/simulate/step/cuda/impulse_segments.cuh"
#include "host/simulate/step/resident_state.hpp"
#include "kernels/body/step_summary.hpp"

namespace tetwarp {

template <class T>
class CudaResidentState final : public ResidentState {
 public:
  using Exec = CudaExec;

  /// @param exec, model, pipeline  kept by the caller
  CudaResidentState(Exec& exec, const Model& model, BodyPipeline<Exec, T>& pipeline)
      : exec_(exec),
        model_(model),
        pipeline_(pipeline),
        constants_(pipeline.constants()),
        now_(pipeline.arrays()),
        segments_(model) {
    exec_.put(segments_.runs, runs_);
    exec_.put(segments_.segments, of_segments_);
    run_sums_.resize(count_of(segments_.runs));
    sums_.resize(count_of(segments_.segments));
    host_sums_.reserve(count_of(segments_.segments));
    check_.resize(1);
    host_check_.reserve(1);
  }

  void save() override {
    const DeviceScope scope = exec_.enter();
    for_each_part([&](auto& own, auto& saved) { exec_.keep(view(own), saved); });
  }
  void restore() override {
    const DeviceScope scope = exec_.enter();
    for_each_part([&](auto& own, auto& saved) { exec_.keep(view(saved), own); });
    pipeline_.forget_steps();
  }

  StateCheck check() override {
    const DeviceScope scope = exec_.enter();
    const StateCheckOp body = {view(now_.position),
                               view(now_.velocity),
                               {view(now_.center), view(now_.rotation)},
                               view(now_.angular_momentum),
                               view(moments_)};
    exec_.sum_to(label, 0, terms(), body, check_.view().data);
    StateCheck* const result = host_check_.view(1).data;
    exec_.get(view(check_), result);
    return *result;
  }

  void watch_spins(const std::vector<Point3>& moments) override {
    const DeviceScope scope = exec_.enter();
    const View<const double> numbers = numbers_of(moments);
    exec_.put(numbers.data, numbers.size, moments_);
  }

  void add_sums(const StepInput& input, StepSums& sums) override {
    const std::int64_t count = count_of(segments_.segments);
    if (count == 0) return;
    const DeviceScope scope = exec_.enter();
    const StepImpulseOp body = {
        model_.node_count,  model_.rigid_count,     view(now_.support),
        view(now_.force),   view(now_.velocity),    input.time_step,
        constants_.springs, view(now_.spring_pull), view(now_.anchor_velocity)};
    sum_runs(view(runs_), body, run_sums_.view());
    sum_runs(view(of_segments_), ReadySums<ImpulseSums>{view(run_sums_)}, sums_.view());
    ImpulseSums* const totals = host_sums_.view(count).data;
    exec_.get(view(sums_), totals);
    add_totals(totals, sums);
  }

  void watch(const StatePlaces& places) override {
    const DeviceScope scope = exec_.enter();
    exec_.put(places.nodes, watched_nodes_);
    exec_.put(places.rigid, watched_rigid_);
    places_.resize(3 * count_of(places.nodes) + 7 * count_of(places.rigid));
    host_places_.resize(static_cast<std::size_t>(view(places_).size));
    watched_ = places;
  }
  void read_watched(ModelState& state) override {
    if (watched_.empty()) return;
    const DeviceScope scope = exec_.enter();
    exec_.for_each(label, count_of(watched_.nodes) + count_of(watched_.rigid),
                   PlaceCopyOp{view(watched_nodes_),
                               view(watched_rigid_),
                               view(now_.position),
                               {view(now_.center), view(now_.rotation)},
                               places_.view()});
    exec_.get(view(places_), host_places_.data());
    const double* from = host_places_.data();
    for (const std::int32_t n : watched_.nodes) {
      std::copy_n(from, 3, state.position[static_cast<std::size_t>(n)].data());
      from += 3;
    }
    for (const std::int32_t r : watched_.rigid) {
      std::copy_n(from, 3, state.position[static_cast<std::size_t>(model_.node_count + r)].data());
      std::copy_n(from + 3, 4, state.rotation[static_cast<std::size_t>(r)].data());
      from += 7;
    }
  }

 private:
  static constexpr const char* label = "body/update";

  template <class Value>
  static View<const Value> view(const DeviceVector<Value>& values) {
    return values.view();
  }
  std::int64_t terms() const { return model_.node_count + std::int64_t{model_.rigid_count}; }

  template <class Visit>
  void for_each_part(const Visit& visit) {
    visit(now_.position, position_);
    visit(now_.center, center_);
    visit(now_.rotation, rotation_);
    visit(now_.velocity, velocity_);
    visit(now_.angular_momentum, angular_momentum_);
  }
  template <class Term>
  void sum_runs(View<const SumRun> runs, const Term& term, View<ImpulseSums> sums) {
    if (runs.size == 0) return;
    launch(exec_.stream(), run_sums_kernel<ImpulseSums, Term>,
           dim3(static_cast<unsigned>(runs.size)), dim3(sum_threads),
           sum_warps * sizeof(ImpulseSums), runs, term, sums);
  }
  static void add(const double* from, Point3& to) {
    for (std::size_t i = 0; i < 3; ++i) to[i] += from[i];
  }
  void add_totals(const ImpulseSums* totals, StepSums& sums) const {
    const std::size_t bodies = sums.support.size();
    for (std::int64_t b = 0; b < segments_.body_count; ++b) {
      const double* const of = totals[b].value;
      sums.work += of[6];
      if (static_cast<std::size_t>(b) >= bodies) continue;
      add(of, sums.support[static_cast<std::size_t>(b)]);
      add(of + 3, sums.load[static_cast<std::size_t>(b)]);
    }
    const ImpulseSums* of_group = totals + segments_.body_count;
    for (const ImpulseSegments::SpringGroup& group : segments_.groups) {
      const double* const of = (of_group++)->value;
      const double opposite[3] = {-of[0], -of[1], -of[2]};
      const bool is_handle = group.handle >= 0;
      sums.work += of[6];
      auto& on_bodies = is_handle ? sums.handle : sums.coupling;
      const auto is_body = [&](std::int32_t b) {
        return b >= 0 && static_cast<std::size_t>(b) < bodies;
      };
      if (is_body(group.body_a)) add(of, on_bodies[static_cast<std::size_t>(group.body_a)]);
      if (is_handle) continue;
      if (is_body(group.body_b)) add(opposite, on_bodies[static_cast<std::size_t>(group.body_b)]);
      if (group.coupling >= 0) add(of, sums.on_a[static_cast<std::size_t>(group.coupling)]);
    }
  }

  Exec& exec_;
  const Model& model_;
  BodyPipeline<Exec, T>& pipeline_;
  const ConstantArrays<Exec>& constants_;
  StepArrays<Exec>& now_;
  ImpulseSegments segments_;
  DeviceVector<SumRun> runs_, of_segments_;
  DeviceVector<ImpulseSums> run_sums_, sums_;
  PinnedBuffer<ImpulseSums> host_sums_;
  DeviceVector<double> moments_;  ///< of the bodies whose spin counts
  DeviceVector<StateCheck> check_;
  PinnedBuffer<StateCheck> host_check_;
  StatePlaces watched_;
  DeviceVector<std::int32_t> watched_nodes_, watched_rigid_;
  DeviceVector<double> places_;
  std::vector<double> host_places_;
  DeviceVector<double> position_, center_, rotation_, velocity_, angular_momentum_;  ///< saved
};

}  // namespace tetwarp
