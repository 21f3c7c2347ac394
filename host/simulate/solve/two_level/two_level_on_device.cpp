/// @file two_level_on_device.cpp
/// Starts the iteration of a device, and reads its results.
#include "host/simulate/solve/two_level/two_level_on_device.hpp"

#include <utility>

#include "host/base/index_of.hpp"
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

TwoLevelOnDevice::TwoLevelOnDevice(const SceneSurfaces& scene,
                                   const Model& model,
                                   const ContactOptions& options,
                                   std::shared_ptr<RestFactors> factors)
    : scene_(scene),
      options_(options),
      factors_(std::move(factors)),
      maker_(bodies_with_inverses(model, *factors_),
             CoupledControl::omega(options.expert.relaxation)) {}

bool TwoLevelOnDevice::can_take(const std::vector<std::uint8_t>& takes) const {
  for (std::size_t i = 0; i < takes.size(); ++i) {
    const std::int32_t body = factors_->body_of_island(static_cast<std::int32_t>(i));
    if (takes[i] != 0 && body >= 0 && !maker_.has_inverse(i)) return false;
  }
  return true;
}

CoupledOutcome TwoLevelOnDevice::solve(ResidentTwoLevel& resident,
                                       const SoftProblem& problem,
                                       std::vector<Point3>& velocity) {
  maker_.make(resident.rows(), problem.islands, problem.takes);
  start_.set(problem, maker_.lists(), *factors_);
  const CoupledOutcome outcome =
      resident.solve(binding_of(scene_), maker_.lists(), start_, *factors_, options_);
  if (outcome.is_result) take_results(resident.results(), velocity);
  return outcome;
}

void TwoLevelOnDevice::take_results(const ResidentResults& results, std::vector<Point3>& velocity) {
  const CompliantLists& lists = maker_.lists();
  impulse_.assign(results.impulse.begin(), results.impulse.end());
  contact_velocity_.assign(results.velocity.begin(), results.velocity.end());
  for (std::size_t c = 0; c < start_.laws.preload.size(); ++c) {
    impulse_[3 * c] -= start_.laws.preload[c];
  }
  for (std::size_t row = 0; row < lists.model_block.size(); ++row) {
    Point3& own = velocity[index_of(lists.model_block[row])];
    for (std::size_t i = 0; i < 3; ++i) own[i] = results.body_velocity[3 * row + i];
  }
}

}  // namespace tetwarp
