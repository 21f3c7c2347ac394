/// @file deformable_solver.cpp
/// Solves on the device where bodies are stepped there, else on the host.
#include "host/simulate/solve/deformable_solver.hpp"

#include <utility>

#include "host/base/index_of.hpp"
#include "host/simulate/solve/problem/contact_laws.hpp"
#include "host/simulate/step/device_stepper.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"

namespace tetwarp {
namespace {

// Inverses of 3 n x 3 n numbers of float32: of one body up to 36 MB, of all up to 512 MiB for each
// of the last lengths of a step. Larger bodies are left to the host, which has sparse factors.
constexpr std::int64_t most_nodes = 1000;
constexpr std::int64_t most_numbers = std::int64_t{1} << 27;

/// [coupling islands] elastic body that gives way by its inverse, or -1.
std::vector<std::int32_t> bodies_with_inverses(const Model& model, const RestFactors& factors) {
  std::vector<std::int32_t> body_of(index_of(model.island_count), -1);
  std::int64_t numbers = 0;
  for (std::int32_t island = 0; island < model.island_count; ++island) {
    const std::int32_t body = factors.body_of_island(island);
    if (body < 0) continue;
    const std::int64_t nodes =
        model.body_node[index_of(body) + 1] - model.body_node[index_of(body)];
    if (nodes > most_nodes || numbers + 9 * nodes * nodes > most_numbers) continue;
    numbers += 9 * nodes * nodes;
    body_of[index_of(island)] = body;
  }
  return body_of;
}

}  // namespace

DeformableSolver::DeformableSolver(const SceneSurfaces& scene,
                                   const Model& model,
                                   const ContactOptions& options,
                                   std::shared_ptr<RestFactors> factors)
    : scene_(scene),
      options_(options),
      factors_(factors ? std::move(factors) : std::make_shared<RestFactors>(model)),
      on_host_(model, options, factors_),
      on_device_(bodies_with_inverses(model, *factors_),
                 CoupledControl::omega(options.expert.relaxation)) {}

/// Whether all elastic bodies among islands that have factors on the host have inverses.
bool DeformableSolver::has_inverses(const std::vector<std::uint8_t>& takes) const {
  for (std::size_t i = 0; i < takes.size(); ++i) {
    const std::int32_t body = factors_->body_of_island(static_cast<std::int32_t>(i));
    if (takes[i] != 0 && body >= 0 && !on_device_.has_inverse(i)) return false;
  }
  return true;
}

bool DeformableSolver::begin(BodyStepper& stepper, const ContactShare& share) {
  const bool can_try = options_.backend == Backend::cuda && !share.is_empty() &&
                       stepper.on_device() != nullptr && has_inverses(share.islands);
  resident_ = can_try ? &stepper.on_device()->resident_two_level() : nullptr;
  return can_try;
}

CoupledOutcome DeformableSolver::solve_on_device(const SoftProblem& problem,
                                                 std::vector<Point3>& velocity) {
  on_device_.make(resident_->rows(), problem.islands, problem.takes);
  const CompliantLists& lists = on_device_.lists();
  start_.set(problem, lists, *factors_);
  const CoupledOutcome outcome =
      resident_->solve(binding_of(scene_), lists, start_, *factors_, options_);
  if (!outcome.is_result) return outcome;
  const ResidentResults results = resident_->results();
  device_impulse_.assign(results.impulse.begin(), results.impulse.end());
  start_.finish(lists, results.body_velocity, device_impulse_, velocity);
  impulse_ = device_impulse_;
  contact_velocity_ = results.velocity;
  return outcome;
}

CoupledOutcome DeformableSolver::solve(BodyStepper& stepper,
                                       const SoftProblem& all,
                                       StepRows& rows,
                                       std::vector<Point3>& velocity) {
  gather_laws(all.contacts, all.laws, laws_);
  const SoftProblem problem = {all.state, all.islands,  all.sides, all.rows,
                               all.takes, all.contacts, laws_,     all.change};
  CoupledOutcome on_device;
  if (resident_ != nullptr) {
    on_device = solve_on_device(problem, velocity);
    if (!on_device.is_result) resident_ = nullptr;
    if (on_device.is_result || on_device.is_stopped) return on_device;
  }
  rows.set_all();
  CoupledOutcome on_host = on_host_.solve(stepper.system(), problem, velocity);
  impulse_ = on_host_.impulse();
  contact_velocity_ = on_host_.contact_velocity();
  on_host.outer_iterations += on_device.outer_iterations;
  on_host.sweeps += on_device.sweeps;
  return on_host;
}

}  // namespace tetwarp
