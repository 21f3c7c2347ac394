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

/// [bodies] Whether each has a factor too large for an inverse.
std::vector<std::uint8_t> find_large(const Model& model, const RestFactors& factors) {
  std::vector<std::uint8_t> is_large(model.body_island.size(), 0);
  std::int64_t numbers = 0;
  for (std::size_t body = 0; body < is_large.size(); ++body) {
    if (!factors.has(static_cast<std::int32_t>(body))) continue;
    const std::int64_t nodes = model.body_node[body + 1] - model.body_node[body];
    is_large[body] = nodes > most_nodes || numbers + 9 * nodes * nodes > most_numbers ? 1 : 0;
    if (is_large[body] == 0) numbers += 9 * nodes * nodes;
  }
  return is_large;
}

/// [coupling islands] Whether an island has such a body.
std::vector<std::uint8_t> islands_with_large(const Model& model, const RestFactors& factors) {
  const std::vector<std::uint8_t> is_large = find_large(model, factors);
  std::vector<std::uint8_t> has_large(index_of(model.island_count), 0);
  for (std::size_t body = 0; body < is_large.size(); ++body) {
    if (is_large[body] != 0) has_large[index_of(model.body_island[body])] = 1;
  }
  return has_large;
}

}  // namespace

DeformableSolver::DeformableSolver(const SceneSurfaces& scene,
                                   const Model& model,
                                   const ContactOptions& options,
                                   std::shared_ptr<RestFactors> factors)
    : scene_(scene),
      options_(options),
      factors_(factors ? std::move(factors) : std::make_shared<RestFactors>(model)),
      has_large_(islands_with_large(model, *factors_)),
      on_host_(model, options, factors_),
      on_device_(factors_->bodies_of_blocks(), CoupledControl::omega(options.expert.relaxation)) {}

/// Whether all elastic bodies of islands have inverses.
bool DeformableSolver::has_inverses(const std::vector<std::uint8_t>& takes) const {
  for (std::size_t i = 0; i < takes.size(); ++i) {
    if (takes[i] != 0 && has_large_[i] != 0) return false;
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
