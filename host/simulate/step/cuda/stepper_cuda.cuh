/// @file stepper_cuda.cuh
/// CudaStepper: BodyPipeline on a device.
#pragma once
#include <string>
#include <utility>

#include "host/simulate/step/body_pipeline.hpp"
#include "host/simulate/step/cuda/island_gradients_cuda.cuh"
#include "host/simulate/step/cuda/resident_contacts_cuda.cuh"
#include "host/simulate/step/cuda/resident_state_cuda.cuh"
#include "host/simulate/step/cuda/resident_surfaces_cuda.cuh"
#include "host/simulate/step/cuda/resident_two_level_cuda.cuh"
#include "host/simulate/step/device_stepper.hpp"

namespace tetwarp {

template <class T>
class CudaStepper final : public DeviceStepper {
 public:
  CudaStepper(const Model& model, const StepperOptions& options, std::string name)
      : exec_(options.device),
        islands_(exec_),
        pipeline_(exec_, islands_, model, options),
        resident_(exec_, model, pipeline_),
        contacts_(exec_, pipeline_),
        surfaces_(exec_, model, pipeline_.arrays()),
        two_level_(exec_, model, pipeline_, surfaces_),
        name_(std::move(name)) {}

  std::string device() const override { return name_; }
  void set_state(const ModelState& state) override {
    const DeviceScope scope = exec_.enter();
    pipeline_.set_state(state);
  }
  void get_state(ModelState& state) const override {
    const DeviceScope scope = exec_.enter();
    pipeline_.get_state(state);
  }
  StepOutcome solve(const StepInput& input) override {
    const DeviceScope scope = exec_.enter();
    return pipeline_.solve(input);
  }
  StepSystem system() override {
    const DeviceScope scope = exec_.enter();
    return pipeline_.system();
  }
  void get_velocities(std::vector<Point3>& velocity) const override {
    const DeviceScope scope = exec_.enter();
    pipeline_.get_velocities(velocity);
  }
  void set_velocities(const std::vector<Point3>& velocity) override {
    const DeviceScope scope = exec_.enter();
    pipeline_.set_velocities(velocity);
  }
  double move(double time_step, std::span<const double> fraction) override {
    const DeviceScope scope = exec_.enter();
    return pipeline_.move(time_step, fraction);
  }
  std::vector<Point3> support_impulses() const override {
    const DeviceScope scope = exec_.enter();
    return pipeline_.support_impulses();
  }
  PositionsView positions(std::int32_t first_node, std::int32_t count) const override {
    const DeviceScope scope = exec_.enter();
    exec_.wait();  // whoever reads them does so on a stream of its own
    return {pipeline_.position_of(first_node), count, Memory::device};
  }
  ResidentState& resident_state() override { return resident_; }
  ResidentSurfaces& resident_surfaces() override { return surfaces_; }
  ResidentContacts& resident_contacts() override { return contacts_; }
  ResidentTwoLevel& resident_two_level() override { return two_level_; }

 private:
  mutable CudaExec exec_;  ///< reads need its stream
  IslandGradients<CudaExec> islands_;
  BodyPipeline<CudaExec, T> pipeline_;
  CudaResidentState<T> resident_;
  CudaResidentContacts<T> contacts_;
  CudaResidentSurfaces surfaces_;
  CudaResidentTwoLevel<T> two_level_;
  std::string name_;
};

inline std::unique_ptr<BodyStepper> make_stepper_on_device(const Model& model,
                                                           const StepperOptions& options,
                                                           const std::string& name) {
  const DeviceScope scope(options.device);
  if (options.float32_solve) return std::make_unique<CudaStepper<float>>(model, options, name);
  return std::make_unique<CudaStepper<double>>(model, options, name);
}

}  // namespace tetwarp
