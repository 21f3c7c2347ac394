#include "host/simulate/contact/elastic_islands.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>
#include <utility>

#include "host/simulate/contact/contact_laws.hpp"

namespace tetwarp {
namespace {

// Inverses of 3 n x 3 n numbers of float32: of one body up to 81 MB, of all up to 1 GiB.
constexpr std::int64_t most_nodes = 1500;
constexpr std::int64_t most_numbers = std::int64_t{1} << 28;

}  // namespace

ElasticIslands::ElasticIslands(const Model& model,
                               const ContactOptions& options,
                               std::shared_ptr<RestFactors> factors)
    : options_(options),
      factors_(std::move(factors)),
      is_possible_(index_of(model.island_count), 0) {
  std::vector<std::int32_t> bodies(is_possible_.size(), 0);
  std::int64_t numbers = 0;
  for (std::size_t body = 0; body < model.body_island.size(); ++body) {
    const std::int32_t island = model.body_island[body];
    if (island < 0) continue;
    ++bodies[index_of(island)];
    is_possible_[index_of(island)] = model.body_rigid[body] >= 0;
    if (factors_->body_of_island(island) < 0) continue;
    const std::int64_t nodes = model.body_node[body + 1] - model.body_node[body];
    if (nodes > most_nodes || numbers + 9 * nodes * nodes > most_numbers) continue;
    numbers += 9 * nodes * nodes;
    is_possible_[index_of(island)] = 1;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i] > 1) is_possible_[i] = 0;
  }
}

TwoLevelOutcome ElasticIslands::solve(BodyStepper& stepper,
                                      const ModelState& state,
                                      const ContactIslands& islands,
                                      const ContactRows& rows,
                                      const std::vector<std::uint8_t>& takes,
                                      const std::vector<std::int32_t>& contacts,
                                      const ContactProblem& laws,
                                      const std::vector<Point3>& change,
                                      std::vector<Point3>& velocity) {
  ResidentElastic& resident = *stepper.resident_elastic();
  maker_.make(resident.rows(), islands, *factors_, rows, takes, contacts);
  set_start(state, contacts, laws,
            change.size() == velocity.size() ? change : std::vector<Point3>{});
  const TwoLevelOutcome outcome = resident.solve(maker_.lists(), start_, *factors_, options_);
  if (outcome.is_result) take_results(resident.results(), velocity);
  return outcome;
}

/// The laws of the contacts, and the rotations of the bodies.
void ElasticIslands::set_start(const ModelState& state,
                               const std::vector<std::int32_t>& contacts,
                               const ContactProblem& laws,
                               const std::vector<Point3>& change) {
  ElasticLists& lists = maker_.lists();
  gather_laws(contacts, laws, laws_);
  start_.time_step = laws.adhesion.time_step;
  start_.laws.set(laws_);
  start_.offset = laws_.velocity_offset;
  start_.impulse = laws_.impulse_guess;
  for (std::size_t c = 0; c < start_.laws.preload.size(); ++c) {
    start_.impulse[3 * c] += start_.laws.preload[c];
  }
  start_.change.clear();
  if (!change.empty()) {
    for (const std::int32_t block : lists.model_block) {
      const Point3& own = change[index_of(block)];
      start_.change.insert(start_.change.end(), own.begin(), own.end());
    }
  }
  factors_->set_time_step(start_.time_step);
  for (std::size_t b = 0; b < lists.bodies.size(); ++b) {
    if (lists.model_body[b] < 0) continue;
    const auto rotation =
        factors_->of_body(lists.model_body[b]).mean_rotation(state.position.front().data());
    std::ranges::copy(rotation, lists.bodies[b].rotation);
  }
}

void ElasticIslands::take_results(const ResidentResults& results, std::vector<Point3>& velocity) {
  const ElasticLists& lists = maker_.lists();
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
