/// @file stepper_cpu.cpp
/// make_cpu_stepper(): BodyPipeline on host threads.
#include "host/base/warp_backend.hpp"
#include "host/simulate/step/body_pipeline.hpp"
#include "host/simulate/step/cpu/island_gradients_cpu.hpp"
#include "host/simulate/step/cpu/rest_gradients.hpp"
#include "host/simulate/step/cpu/stages_cpu.hpp"

namespace tetwarp {
namespace {
template <class T>
class CpuStepper final : public BodyStepper {
 public:
  CpuStepper(const Model& model, const StepperOptions& options)
      : rest_(model, options.factors),
        exec_(thread_count(options.threads)),
        islands_(exec_, rest_),
        pipeline_(exec_, islands_, model, options) {}

  std::string device() const override { return processor_name(); }
  void set_state(const ModelState& state) override { pipeline_.set_state(state); }
  void get_state(ModelState& state) const override { pipeline_.get_state(state); }
  StepOutcome solve(const StepInput& input) override {
    rest_.begin(input.time_step, pipeline_.position_of(0));
    return pipeline_.solve(input);
  }
  StepSystem system() override {
    StepSystem system = pipeline_.system();
    system.factors = &islands_.factors();
    return system;
  }
  void get_velocities(std::vector<Point3>& velocity) const override {
    pipeline_.get_velocities(velocity);
  }
  void set_velocities(const std::vector<Point3>& velocity) override {
    pipeline_.set_velocities(velocity);
  }
  double move(double time_step, std::span<const double> fraction) override {
    return pipeline_.move(time_step, fraction);
  }
  std::vector<Point3> support_impulses() const override { return pipeline_.support_impulses(); }
  PositionsView positions(std::int32_t first_node, std::int32_t count) const override {
    return {pipeline_.position_of(first_node), count, Memory::host};
  }

 private:
  RestGradients rest_;
  CpuExec exec_;
  IslandGradients<CpuExec> islands_;
  BodyPipeline<CpuExec, T> pipeline_;
};
}  // namespace

std::unique_ptr<BodyStepper> make_cpu_stepper(const Model& model, const StepperOptions& options) {
  if (options.float32_solve) return std::make_unique<CpuStepper<float>>(model, options);
  return std::make_unique<CpuStepper<double>>(model, options);
}

}  // namespace tetwarp
