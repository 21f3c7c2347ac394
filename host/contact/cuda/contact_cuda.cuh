/// @file contact_cuda.cuh
/// The contact solver on a device. An island that fits one block is solved by one kernel launch;
/// larger ones, and those whose blocks A couples, run stage by stage on the whole device.
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/contact/block_jacobi/block_jacobi.hpp"
#include "host/contact/cuda/device.hpp"
#include "host/contact/cuda/device_memory.cuh"
#include "host/contact/cuda/island_runs.cuh"
#include "host/contact/cuda/resident.cuh"
#include "host/contact/structure/indices.hpp"
#include "host/contact/sweeps/run.hpp"
#include "kernels/contact/contact_components.hpp"
#include "kernels/contact/cuda/device_sweep.cuh"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

class CudaContactDevice final : public ContactDevice {
 public:
  CudaContactDevice(int device, std::string name)
      : exec_(device, StageClocks::off), runs_(exec_), name_(std::move(name)) {}

  ContactSavings set_problem(const ContactOptions& options,
                             const ContactStructure& structure,
                             const ContactInput& input) override {
    const DeviceScope scope(exec_.number());
    set_structure(structure);
    return runs_.set_problem(options, structure, indices_,
                             input_on_device(exec_, input, input_in_memory_));
  }

  std::int64_t solve_uncoupled(const ContactOptions& options,
                               std::vector<double>& impulse,
                               std::vector<double>& body_velocity,
                               std::vector<IslandOutcome>& outcomes) override {
    const DeviceScope scope(exec_.number());
    const std::int64_t skipped = runs_.solve(
        options, [&] { exec_.put(impulse, runs_.impulse()); }, budget, outcomes);
    exec_.get(runs_.impulse(), impulse);
    exec_.get(runs_.body_velocity(), body_velocity);
    return skipped;
  }

  void solve_coupled(const ContactOptions& options,
                     const ContactIsland& island,
                     const std::vector<double>& guess,
                     std::int64_t max_iterations,
                     std::vector<double>& impulse,
                     std::vector<double>& body_velocity,
                     IslandOutcome& outcome) override {
    const DeviceScope scope(exec_.number());
    exec_.put(guess, guess_);
    const auto colors = view_of(structure_->color_start);
    const auto start = view_of(std::as_const(guess_));
    const CoupledTask task{options, island, colors, runs_.numbers(), start, max_iterations, budget};
    const CoupledSolution best = solve_coupled_island(exec_, task, block_jacobi_memory_, outcome);
    exec_.get(best.impulse, impulse.data());
    exec_.get(best.body_velocity, body_velocity.data());
  }

  ResidentEnd solve_resident(const ContactOptions& options,
                             const ContactStructure& structure,
                             const ResidentProblem& problem,
                             std::vector<IslandOutcome>& outcomes) override {
    const DeviceScope scope(exec_.number());
    const CallersStream stream(exec_, problem.stream);
    set_structure(structure);
    resident_.set_pattern(exec_, *problem.pattern, structure.serial);
    ResidentEnd end;
    ContactInput input = problem.input;
    input.given_velocity = resident_.recovered(exec_, input, options.recovery_speed);
    end.savings = runs_.set_problem(options, structure, indices_, input);
    if (!resident_.is_plain(exec_, problem, indices_, runs_.numbers())) return end;
    const auto start = [&] {
      if (problem.guess.size == 0) return;
      exec_.for_each(
          "contact/setup", indices_.slots(),
          GatherOp<3>{indices_.contact_of_slot, problem.guess, view_of(runs_.impulse())});
    };
    end.updates_skipped = runs_.solve(options, start, budget, outcomes);
    end.has_run = true;
    const auto converged = [](const IslandOutcome& outcome) {
      return outcome.reason == StopReason::converged;
    };
    if (!std::all_of(outcomes.begin(), outcomes.end(), converged)) {
      exec_.get(runs_.impulse(), end.impulse);
      exec_.get(runs_.body_velocity(), end.body_velocity);
      return end;
    }
    const ResultSums sums = resident_.write_results(exec_, problem, indices_, runs_.numbers(),
                                                    view_of(std::as_const(runs_.impulse())),
                                                    view_of(std::as_const(runs_.body_velocity())));
    end.is_solved = sums.bad() == 0;
    end.has_run = end.is_solved;
    end.balance = structure.is_local ? 0 : sums.balance();
    return end;
  }

  bool is_device_memory(const void* data) const override {
    const DeviceScope scope(exec_.number());
    cudaPointerAttributes attributes;
    check_cuda(cudaPointerGetAttributes(&attributes, data), "cudaPointerGetAttributes");
    return (attributes.type == cudaMemoryTypeDevice && attributes.device == exec_.number()) ||
           attributes.type == cudaMemoryTypeManaged;
  }

  void read(const double* device, std::int64_t size, double* host, void* stream) override {
    const DeviceScope scope(exec_.number());
    const CallersStream callers(exec_, stream);
    exec_.get(View<const double>{device, size}, host);
  }

  void write(const double* host, std::int64_t size, double* device, void* stream) override {
    const DeviceScope scope(exec_.number());
    const CallersStream callers(exec_, stream);
    check_cuda(cudaMemcpyAsync(device, host, index_of(size) * sizeof(double),
                               cudaMemcpyHostToDevice, exec_.stream()),
               "cudaMemcpyAsync to device");
    exec_.wait();
  }

  std::vector<std::int32_t> lowest_connected(const Lists& lists, std::int64_t item_count) override {
    const DeviceScope scope(exec_.number());
    input_in_memory_.restart();
    labels_.resize(item_count);
    contact_components(exec_, on_device(lists.start), on_device(lists.item), view_of(labels_));
    return labels();
  }

  void evolve(const ContactAdhesionOp& op) override {
    const DeviceScope scope(exec_.number());
    ContactAdhesionOp on_device = op;
    on_device.in = adhesion_on_device(exec_, op.in, input_in_memory_);
    next_intensity_.resize(op.next_intensity.size);
    next_gap_.resize(op.next_gap.size);
    debonded_.resize(op.debonded.size);
    on_device.next_intensity = view_of(next_intensity_);
    on_device.next_gap = view_of(next_gap_);
    on_device.debonded = view_of(debonded_);
    contact_adhesion(exec_, on_device);
    exec_.get(view_of(std::as_const(next_intensity_)), op.next_intensity.data);
    exec_.get(view_of(std::as_const(next_gap_)), op.next_gap.data);
    exec_.get(view_of(std::as_const(debonded_)), op.debonded.data);
  }

  void evolve_resident(const ContactAdhesionOp& op, void* stream) override {
    const DeviceScope scope(exec_.number());
    const CallersStream callers(exec_, stream);
    contact_adhesion(exec_, op);
  }

  std::string name() const override { return name_; }

 private:
  /// Runs kernels on the stream of a caller, or after the default stream, until it is destroyed.
  class CallersStream {
   public:
    CallersStream(CudaExec& exec, void* stream) : exec_(exec) { exec.follow(stream); }
    CallersStream(const CallersStream&) = delete;
    CallersStream& operator=(const CallersStream&) = delete;
    ~CallersStream() { exec_.drain(); }

   private:
    CudaExec& exec_;
  };

  void set_structure(const ContactStructure& structure) {
    structure_ = &structure;
    if (serial_ == structure.serial) return;
    exec_.forget_parts();  // a new structure may move the arrays
    indices_in_memory_.restart();
    indices_ = make_indices(structure, [&](const auto& array) {
      return indices_in_memory_.put(exec_, view_of(array));
    });
    serial_ = structure.serial;
  }

  template <class T>
  View<const T> on_device(const std::vector<T>& host) {
    return input_in_memory_.put(exec_, view_of(host));
  }
  std::vector<std::int32_t> labels() {
    std::vector<std::int32_t> result;
    exec_.get(labels_, result);
    return result;
  }

  CudaExec exec_;
  IslandRuns runs_;
  ResidentArrays resident_;
  std::string name_;
  const ContactStructure* structure_ = nullptr;
  std::int64_t serial_ = 0;  ///< of the structure that `indices_` were copied from
  DeviceArrays indices_in_memory_, input_in_memory_;
  ContactIndices indices_;  ///< views of indices_in_memory_
  BlockJacobiMemory<CudaExec> block_jacobi_memory_;
  DeviceVector<double> guess_, next_intensity_, next_gap_;
  DeviceVector<std::int32_t> labels_;
  DeviceVector<std::uint8_t> debonded_;
};

}  // namespace tetwarp
