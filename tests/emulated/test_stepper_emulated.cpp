/// @file test_stepper_emulated.cpp
/// Calls of the CUDA runtime in steps of back end cuda, which the emulated device records; inverses
/// of systems at rest that are kept in its memory.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include <Eigen/Dense>

#include "host/base/index_of.hpp"
#include "host/simulate/step/cuda/compliance_store.cuh"
#include "tests/emulated/device_calls.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
/// An elastic block with a held node, and a rigid body tied to it.
Model small_block() {
  Model model = empty_model();
  const std::int32_t block = add_block(model, {.cells = {2, 2, 2}, .gamma = 1e-3});
  model.prescribed[0] = 1;
  const std::int32_t rigid = add_rigid(model, 0.5, {1e-3, 2e-3, 2e-3}, {-0.2, 0.1, 0.1});
  add_spring(model, rigid_point(model, rigid, {0.1, 0.02, 0}), node_point(model, block + 3), 500,
             2);
  return model;
}

TEST(StepperEmulated, AStepAllocatesNothing) {
  const Model model = small_block();
  const auto stepper = make_cuda_stepper(model, {});
  stepper->step(input_for(model, 5e-3));
  take_calls();

  stepper->step(input_for(model, 5e-3));

  const DeviceCalls calls = take_calls();
  EXPECT_EQ(calls.count(DeviceCall::allocate), 0);
  EXPECT_EQ(calls.count(DeviceCall::release), 0);
  EXPECT_LT(calls.count(DeviceCall::launch), 30);
}

/// An island of 1,209 rows that is solved to a tight tolerance.
Model large_block() {
  Model model = empty_model();
  add_block(model, {.cells = {10, 9, 10}, .youngs = 1e7});
  model.prescribed[0] = 1;
  return model;
}

/// Any number of iterations is one launch of a grid and one read.
TEST(StepperEmulated, LargeIslandsAreSolvedByOneLaunch) {
  const Model model = large_block();
  const StepInput input = input_for(model, 5e-3, {0, 0, -9.81});
  std::vector<DeviceCalls> calls;
  for (const double tolerance : {1e-4, 1e-10}) {
    const auto stepper = make_cuda_stepper(model, {.linear_tolerance = tolerance});
    stepper->step(input);
    take_calls();
    ASSERT_TRUE(stepper->step(input).converged);
    calls.push_back(take_calls());
  }
  EXPECT_EQ(calls[0], calls[1]);
  EXPECT_EQ(calls[1].count(DeviceCall::graph), 0);
  EXPECT_EQ(calls[1].count(DeviceCall::allocate), 0);
  EXPECT_LT(calls[1].count(DeviceCall::launch), 30);
}

/// Where a grid cannot be synchronized, or the caller may end the solve: eight iterations are one
/// launch and one read once the first eight have been made and recorded.
TEST(StepperEmulated, WatchedLargeIslandsIterateAsGraphs) {
  const Model model = large_block();
  StepperOptions options;
  options.linear_tolerance = 1e-10;
  std::int64_t asked = 0;
  options.progress = [&](std::int64_t) { return ++asked > 0; };
  const auto stepper = make_cuda_stepper(model, options);
  const StepInput input = input_for(model, 5e-3, {0, 0, -9.81});
  stepper->step(input);
  take_calls();

  const StepOutcome outcome = stepper->step(input);

  const DeviceCalls calls = take_calls();
  ASSERT_TRUE(outcome.converged);
  ASSERT_GE(outcome.linear_iterations, 48);
  EXPECT_GE(calls.count(DeviceCall::graph), outcome.linear_iterations / 8 - 2);
  EXPECT_LT(calls.count(DeviceCall::copy_to_host), 10 + outcome.linear_iterations / 8);
  EXPECT_GE(asked, outcome.linear_iterations / 8);
  EXPECT_EQ(calls.count(DeviceCall::allocate), 0);
}

/// A number of iterations that is no multiple of eight ends with single ones.
TEST(StepperEmulated, LargeIslandsKeepTheLimitOfIterations) {
  Model model = empty_model();
  add_block(model, {.cells = {10, 9, 10}});
  model.prescribed[0] = 1;
  StepperOptions options;
  options.linear_tolerance = 1e-14;
  options.max_iterations = 21;
  const auto cuda = make_cuda_stepper(model, options), cpu = make_cpu_stepper(model, options);
  const StepInput input = input_for(model, 5e-3, {0, 0, -9.81});

  const StepOutcome outcome = cuda->step(input);
  cpu->step(input);

  EXPECT_EQ(outcome.linear_iterations, 21);
  EXPECT_FALSE(outcome.converged);
  const ModelState a = state_of(*cuda), b = state_of(*cpu);
  for (std::size_t i = 0; i < a.velocity.size(); ++i) {
    EXPECT_LT(distance(a.velocity[i], b.velocity[i]), 1e-9);
  }
}

TEST(StepperEmulated, PositionsAreInDeviceMemory) {
  const Model model = small_block();
  const auto stepper = make_cuda_stepper(model, {});

  const PositionsView view = stepper->positions(3, 5);

  EXPECT_EQ(view.memory, Memory::device);
  EXPECT_EQ(view.node_count, 5);
  EXPECT_TRUE(simt::Device::only().is_on_device(view.xyz, 15 * sizeof(double)));
}

/// A of a body at rest, for its nodes that may move in the order of the model.
Eigen::MatrixXd rest_matrix(const Model& model, std::int32_t body, double time_step) {
  const auto stepper = make_cpu_stepper(model, {});
  stepper->solve(input_for(model, time_step));
  const StepSystem system = stepper->system();
  std::vector<Eigen::Index> place(index_of(model.node_count), -1);
  Eigen::Index count = 0;
  for (std::int32_t n = model.body_node[index_of(body)]; n < model.body_node[index_of(body) + 1];
       ++n) {
    if (model.prescribed[index_of(n)] == 0) place[index_of(n)] = count++;
  }
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  for (std::int32_t row = 0; row < system.rows.unknown_count; ++row) {
    const Eigen::Index i = place[index_of(system.rows.block_of[row])];
    if (i < 0) continue;
    for (std::int64_t k = system.rows.start[row]; k < system.rows.free_end[row]; ++k) {
      const Eigen::Index j = place[index_of(system.rows.block_of[system.rows.column[k]])];
      a.block<3, 3>(3 * i, 3 * j) = Eigen::Map<const Eigen::Matrix3d>(system.values.data + 9 * k);
    }
  }
  return a;
}

/// The inverses of two bodies in a store, each compared with Eigen's.
class StoredInverses {
 public:
  StoredInverses() : model_(two_blocks()), factors_(model_), exec_(0), scope_(exec_.enter()) {
    bodies_[0].frame = 1;
    bodies_[2].frame = 0;
  }

  /// @returns how many inverses were copied to the device
  std::int64_t set(double time_step) {
    factors_.set_time_step(time_step);
    take_calls();
    store_.set_inverses(exec_, factors_, time_step, {1, 0}, bodies_);
    const std::int64_t copies = take_calls().count(DeviceCall::copy_to_device);
    EXPECT_EQ(bodies_[1].inverse, nullptr);
    expect_inverse(bodies_[0], 0, time_step);
    expect_inverse(bodies_[2], 1, time_step);
    return copies;
  }
  const float* of_first() const { return bodies_[0].inverse; }

 private:
  static Model two_blocks() {
    Model model = empty_model();
    add_block(model, {.cells = {2, 2, 1}, .gamma = 1e-3});
    add_block(model, {.cells = {1, 1, 2}, .origin = {1, 0, 0}, .youngs = 1e4});
    model.prescribed[4] = 1;
    return model;
  }
  void expect_inverse(const CompliantBody& body, std::int32_t number, double time_step) {
    const Eigen::MatrixXd expected = rest_matrix(model_, number, time_step).inverse();
    Eigen::MatrixXf found(expected.rows(), expected.cols());
    exec_.get(View<const float>{body.inverse, found.size()}, found.data());
    EXPECT_LE((found.cast<double>() - expected).cwiseAbs().maxCoeff(),
              1e-5 * expected.cwiseAbs().maxCoeff());
  }

  Model model_;
  RestFactors factors_;
  CudaExec exec_;
  DeviceScope scope_;
  ComplianceStore store_;
  std::vector<CompliantBody> bodies_{3};
};

/// Three lengths are kept; a fourth takes the place of the one whose last use is longest ago.
TEST(ComplianceStore, MakesInversesOncePerLengthOfAStep) {
  StoredInverses inverses;
  EXPECT_EQ(inverses.set(1e-3), 2);
  const float* const first = inverses.of_first();
  EXPECT_EQ(inverses.set(1e-3), 0);
  EXPECT_EQ(inverses.set(2e-3), 2);
  EXPECT_NE(inverses.of_first(), first);
  EXPECT_EQ(inverses.set(3e-3), 2);
  EXPECT_EQ(inverses.set(1e-3), 0);
  EXPECT_EQ(inverses.of_first(), first);
  EXPECT_EQ(inverses.set(4e-3), 2);
  EXPECT_EQ(inverses.set(3e-3), 0);
  EXPECT_EQ(inverses.set(1e-3), 0);
  EXPECT_EQ(inverses.set(2e-3), 2);
}

}  // namespace
}  // namespace tetwarp::test
