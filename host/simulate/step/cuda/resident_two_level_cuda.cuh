/// @file resident_two_level_cuda.cuh
/// ResidentTwoLevel on a device.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/step/body_pipeline.hpp"
#include "host/simulate/step/cuda/resident_surfaces_cuda.cuh"
#include "host/simulate/step/cuda/two_level_iteration.cuh"

namespace tetwarp {

template <class T>
class CudaResidentTwoLevel final : public ResidentTwoLevel {
 public:
  /// @param exec, model, pipeline, surfaces  kept by the caller
  CudaResidentTwoLevel(CudaExec& exec,
                       const Model& model,
                       BodyPipeline<CudaExec, T>& pipeline,
                       CudaResidentSurfaces& surfaces)
      : exec_(exec),
        pipeline_(pipeline),
        surfaces_(surfaces),
        iteration_(exec, model.node_count, model.rigid_count) {}

  SystemRows rows() override { return pipeline_.host_rows(); }

  CoupledOutcome solve(const SurfaceBinding& surfaces,
                       const CompliantLists& lists,
                       const TwoLevelStart& start,
                       RestFactors& factors,
                       const ContactOptions& options) override {
    const DeviceScope scope = exec_.enter();
    contact_numbers_ = 3 * start.contacts.size();
    return iteration_.solve(pipeline_.rows(), pipeline_.arrays(), surfaces_.points(surfaces), lists,
                            start, factors, options);
  }

  ResidentResults results() override {
    const DeviceScope scope = exec_.enter();
    const View<const double> all = iteration_.results();
    host_results_.resize(static_cast<std::size_t>(all.size));
    exec_.get(all, host_results_.data());
    const std::span<const double> host = host_results_;
    return {host.first(contact_numbers_), host.subspan(contact_numbers_, contact_numbers_),
            host.subspan(2 * contact_numbers_)};
  }

  void set_velocities() override {
    const DeviceScope scope = exec_.enter();
    exec_.for_each("body/contact", iteration_.model_block().size,
                   ScatterThreeOp{iteration_.model_block(), iteration_.row_velocities(),
                                  pipeline_.arrays().velocity.view()});
  }

 private:
  CudaExec& exec_;
  BodyPipeline<CudaExec, T>& pipeline_;
  CudaResidentSurfaces& surfaces_;
  TwoLevelIteration iteration_;
  std::size_t contact_numbers_ = 0;
  std::vector<double> host_results_;
};

}  // namespace tetwarp
