/// @file compliance_store.cuh
/// Dense inverses of the systems of elastic bodies at rest, in memory of a device.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <utility>
#include <vector>

#include "host/simulate/step/cpu/rest_factors.hpp"
#include "kernels/contact/compliant_body.hpp"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

/// Keeps those of the lengths of a step that were used last.
class ComplianceStore {
 public:
  /// Sets CompliantBody::inverse of elastic bodies; computes what is not there yet.
  /// @param factors     set to the length of the step
  /// @param model_body  [frames] numbers of elastic bodies in the model
  void set_inverses(CudaExec& exec,
                    RestFactors& factors,
                    double time_step,
                    const std::vector<std::int32_t>& model_body,
                    std::vector<CompliantBody>& bodies) {
    Inverses& own = of_time_step(time_step);
    for (CompliantBody& body : bodies) {
      if (body.frame < 0) continue;
      const std::int32_t number = model_body[static_cast<std::size_t>(body.frame)];
      auto found = own.of_body.find(number);
      if (found == own.of_body.end()) {
        DeviceVector<float> inverse;
        factors.of_body(number).inverse(host_);
        exec.put(host_, inverse);
        exec.wait();  // for the copy, before the next one
        found = own.of_body.emplace(number, std::move(inverse)).first;
      }
      body.inverse = found->second.view().data;
    }
  }

 private:
  struct Inverses {
    double time_step = 0;
    std::map<std::int32_t, DeviceVector<float>> of_body;
  };
  static constexpr std::size_t most_time_steps = 3;

  Inverses& of_time_step(double time_step) {
    const auto found = std::ranges::find(kept_, time_step, &Inverses::time_step);
    if (found != kept_.end()) {
      kept_.splice(kept_.end(), kept_, found);  // used last
      return kept_.back();
    }
    if (kept_.size() == most_time_steps) kept_.pop_front();
    kept_.emplace_back();
    kept_.back().time_step = time_step;
    return kept_.back();
  }

  std::list<Inverses> kept_;
  std::vector<float> host_;
};

}  // namespace tetwarp
