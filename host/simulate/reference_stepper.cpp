#include "host/simulate/reference_stepper.hpp"

#include <chrono>
#include <stdexcept>

#include "host/reference/simulate/make_system.hpp"
#include "host/reference/simulate/step_system.hpp"
#include "host/simulate/rotations.hpp"
#include "host/simulate/scene_record.hpp"

namespace tetwarp {
namespace {

using reference::point_of;
using reference::vector_of;

constexpr std::int64_t most_blocks = 2000;  // a dense matrix of 288 MB

class ReferenceStepper final : public BodyStepper {
 public:
  ReferenceStepper(const Scene& scene,
                   const SceneGeometry& geometry,
                   const Model& model,
                   const SceneDrive& drive,
                   const StepperOptions& options)
      : model_(model),
        drive_(drive),
        progress_(options.progress),
        state_(model.start),
        supports_(static_cast<std::size_t>(model.block_count()), Point3{0, 0, 0}) {
    if (model.block_count() > most_blocks) {
      throw std::invalid_argument("backend reference: the scene has " +
                                  std::to_string(model.block_count()) +
                                  " nodes and rigid velocities, its dense matrices take " +
                                  std::to_string(most_blocks) + "; use backend cpu");
    }
    system_ = reference::make_system(scene, geometry);
    twin_ = reference::start_of(system_);
    for (std::int32_t r = 0; r < model.rigid_count; ++r) {
      for (std::size_t of = 0; of < system_.rigids.size(); ++of) {
        if (system_.rigids[of].body == at(model.rigid.body, r)) frame_.push_back(of);
      }
    }
  }

  std::string device() const override { return "dense matrices on the host"; }
  void set_state(const ModelState& state) override { state_ = state; }
  void get_state(ModelState& state) const override { state = state_; }
  std::vector<Point3> support_impulses() const override { return supports_; }
  PositionsView positions(std::int32_t first_node, std::int32_t count) const override {
    const auto first = static_cast<std::size_t>(first_node);
    return {count == 0 ? nullptr : state_.position[first].data(), count, Memory::host};
  }

  StepOutcome step(const StepInput& input) override {
    const auto start = std::chrono::steady_clock::now();
    StepOutcome outcome;
    if (progress_ && !progress_(0)) {
      outcome.completed = false;
      return outcome;
    }
    put_state();
    reference::StepDrive drive;
    drive.time_step = input.time_step;
    drive.end_time = input.end_time;
    drive.before = places_now();
    drive.after = reference::prescribed_at(system_, overrides(), input.end_time);
    const reference::StepResult result = reference::step_once(system_, twin_, drive);
    take_state(result);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    outcome.seconds.linear = outcome.seconds.total = seconds.count();
    return outcome;
  }

 private:
  Eigen::Index block_of(std::int32_t rigid) const {
    return system_.linear_block(static_cast<int>(frame_[static_cast<std::size_t>(rigid)]));
  }

  void put_state() {
    for (std::int32_t n = 0; n < model_.node_count; ++n) {
      const auto node = static_cast<std::size_t>(n);
      twin_.node[node] = vector_of(state_.position[node]);
      twin_.velocity[node] = vector_of(state_.velocity[node]);
    }
    for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
      const auto of = frame_[static_cast<std::size_t>(r)];
      const auto block = static_cast<std::size_t>(block_of(r));
      const Quaternion turn = product(at(state_.rotation, r), conjugate(at(model_.rigid.axes, r)));
      twin_.frame[of] = {vector_of(at(state_.position, model_.node_count + r)),
                         reference::rotation_of(turn)};
      twin_.velocity[block] = vector_of(at(state_.velocity, model_.node_count + 2 * r));
      twin_.velocity[block + 1] = vector_of(angular_velocity_of(model_, state_, r));
      twin_.angular_momentum[of] = vector_of(at(state_.angular_momentum, r));
    }
  }

  void take_state(const reference::StepResult& result) {
    const auto copy_block = [&](Eigen::Index from, std::size_t to) {
      state_.velocity[to] = point_of(result.velocity.segment<3>(3 * from));
      supports_[to] = point_of(result.support.segment<3>(3 * from));
    };
    for (std::int32_t n = 0; n < model_.node_count; ++n) {
      const auto node = static_cast<std::size_t>(n);
      state_.position[node] = point_of(result.state.node[node]);
      copy_block(n, node);
    }
    for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
      const auto rigid = static_cast<std::size_t>(r);
      const auto of = frame_[rigid];
      const auto block = static_cast<std::size_t>(model_.node_count + 2 * r);
      state_.position[static_cast<std::size_t>(model_.node_count) + rigid] =
          point_of(result.state.frame[of].position);
      state_.rotation[rigid] = product(reference::quaternion_of(result.state.frame[of].rotation),
                                       model_.rigid.axes[rigid]);
      state_.angular_momentum[rigid] = point_of(result.state.angular_momentum[of]);
      copy_block(block_of(r), block);
      copy_block(block_of(r) + 1, block + 1);
    }
  }

  /// Where all that is prescribed is at the start of a step.
  reference::Prescribed places_now() const {
    reference::Prescribed now;
    now.nodes.resize(static_cast<std::size_t>(model_.node_count));
    for (std::size_t n = 0; n < now.nodes.size(); ++n) {
      if (model_.prescribed[n] != 0) now.nodes[n] = twin_.node[n];
    }
    now.frames.resize(system_.rigids.size());
    for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
      if (at(model_.rigid.mass, r) > 0) continue;
      const auto of = frame_[static_cast<std::size_t>(r)];
      now.frames[of] = twin_.frame[of];
    }
    for (const auto& handle : drive_.handles()) {
      now.handles.push_back(handle ? std::optional(vector_of(*handle)) : std::nullopt);
    }
    return now;
  }

  reference::Overrides overrides() const {
    reference::Overrides result;
    for (const auto& handle : drive_.overrides().handles) {
      auto& own = result.handles.emplace_back();
      if (!handle) continue;
      own.emplace();
      own->is_released = !handle->has_value();
      if (*handle) own->displacement = vector_of(**handle);
    }
    for (const auto& script : drive_.overrides().scripts) {
      auto& own = result.bodies.emplace_back();
      if (script) own = {vector_of(script->displacement), vector_of(script->axis_angle)};
    }
    return result;
  }

  const Model& model_;
  const SceneDrive& drive_;
  std::function<bool(std::int64_t)> progress_;
  reference::System system_;
  reference::State twin_;
  std::vector<std::size_t> frame_;  ///< [rigids of the model] frames of the reference
  ModelState state_;
  std::vector<Point3> supports_;
};

}  // namespace

std::unique_ptr<BodyStepper> make_reference_stepper(const Scene& scene,
                                                    const SceneGeometry& geometry,
                                                    const Model& model,
                                                    const SceneDrive& drive,
                                                    const StepperOptions& options) {
  return std::make_unique<ReferenceStepper>(scene, geometry, model, drive, options);
}

}  // namespace tetwarp
