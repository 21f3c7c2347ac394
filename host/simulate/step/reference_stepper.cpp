/// @file reference_stepper.cpp
/// Steps the system of the reference, and copies its state.
#include "host/simulate/step/reference_stepper.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "host/reference/simulate/assemble.hpp"
#include "host/reference/simulate/make_system.hpp"
#include "host/reference/simulate/step_system.hpp"
#include "host/simulate/model/rotations.hpp"
#include "host/simulate/step/reference_rows.hpp"
#include "host/simulate/step/scene_record.hpp"

namespace tetwarp {
namespace {

using reference::point_of;
using reference::vector_of;

constexpr std::int64_t most_blocks = 2000;  // a dense matrix of 288 MB

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

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
    std::vector<Eigen::Index> blocks(static_cast<std::size_t>(model.block_count()));
    for_each_block([&](Eigen::Index own, std::size_t block) { blocks[block] = own; });
    rows_ = ReferenceRows(model, std::move(blocks));
  }

  std::string device() const override { return "dense matrices on the host"; }
  void set_state(const ModelState& state) override { state_ = state; }
  void get_state(ModelState& state) const override { state = state_; }
  std::vector<Point3> support_impulses() const override { return supports_; }
  PositionsView positions(std::int32_t first_node, std::int32_t count) const override {
    const auto first = static_cast<std::size_t>(first_node);
    return {count == 0 ? nullptr : state_.position[first].data(), count, Memory::host};
  }

  StepOutcome solve(const StepInput& input) override {
    const auto start = std::chrono::steady_clock::now();
    StepOutcome outcome;
    if (progress_ && !progress_(0)) {
      outcome.completed = false;
      return outcome;
    }
    has_rows_ = false;
    put_state();
    drive_now_.time_step = input.time_step;
    drive_now_.end_time = input.end_time;
    drive_now_.before = places_now();
    drive_now_.after = reference::prescribed_at(system_, overrides(), input.end_time);
    linear_ = reference::assemble(system_, twin_, drive_now_);
    velocity_ = free_velocity_ = reference::solve_step(system_, twin_, drive_now_, linear_);
    for_each_block([&](Eigen::Index own, std::size_t block) {
      if (input.is_asleep.empty() || input.is_asleep[block] == 0) return;
      velocity_.segment<3>(3 * own).setZero();
    });
    free_velocity_ = velocity_;
    outcome.seconds.linear = outcome.seconds.total = seconds_since(start);
    return outcome;
  }
  StepSystem system() override {
    if (!std::exchange(has_rows_, true)) rows_.set(linear_, free_velocity_);
    return rows_.system();
  }
  void get_velocities(std::vector<Point3>& velocity) const override {
    velocity.resize(static_cast<std::size_t>(model_.block_count()));
    for_each_block([&](Eigen::Index from, std::size_t to) {
      velocity[to] = point_of(velocity_.segment<3>(3 * from));
    });
  }
  void set_velocities(const std::vector<Point3>& velocity) override {
    for_each_block([&](Eigen::Index to, std::size_t from) {
      velocity_.segment<3>(3 * to) = vector_of(velocity[from]);
    });
  }
  double move(double, std::span<const double> fraction) override {
    const auto start = std::chrono::steady_clock::now();
    const reference::VectorXd support = reference::support_of(system_, linear_, velocity_);
    take_state(reference::moved_by(system_, twin_, drive_now_, velocity_, fraction));
    get_velocities(state_.velocity);
    for_each_block([&](Eigen::Index from, std::size_t to) {
      supports_[to] = point_of(support.segment<3>(3 * from));
    });
    return seconds_since(start);
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

  /// use(block of the reference, block of the model) for all blocks of the model.
  template <class Use>
  void for_each_block(const Use& use) const {
    for (std::int32_t n = 0; n < model_.node_count; ++n) use(n, static_cast<std::size_t>(n));
    for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
      const auto block = static_cast<std::size_t>(model_.node_count + 2 * r);
      use(block_of(r), block);
      use(block_of(r) + 1, block + 1);
    }
  }

  void take_state(const reference::State& after) {
    for (std::size_t n = 0; n < after.node.size(); ++n) {
      state_.position[n] = point_of(after.node[n]);
    }
    for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
      const auto rigid = static_cast<std::size_t>(r);
      const auto of = frame_[rigid];
      state_.position[static_cast<std::size_t>(model_.node_count) + rigid] =
          point_of(after.frame[of].position);
      state_.rotation[rigid] =
          product(reference::quaternion_of(after.frame[of].rotation), model_.rigid.axes[rigid]);
      state_.angular_momentum[rigid] = point_of(after.angular_momentum[of]);
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
    for (const auto& handle : drive_.state().handles) {
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
    result.delay = drive_.state().delays;
    return result;
  }

  const Model& model_;
  const SceneDrive& drive_;
  std::function<bool(std::int64_t)> progress_;
  reference::System system_;
  reference::State twin_;
  std::vector<std::size_t> frame_;  ///< [rigids of the model] frames of the reference
  ReferenceRows rows_;
  bool has_rows_ = false;           ///< rows_ are those of the present step
  reference::StepDrive drive_now_;  ///< of the running step, like the next members
  reference::LinearSystem linear_;
  reference::VectorXd velocity_, free_velocity_;
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
