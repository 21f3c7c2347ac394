/// @file two_level_start.cpp
/// Gathers contacts, guesses and rotations.
#include "host/simulate/solve/two_level/two_level_start.hpp"
#include "host/base/index_of.hpp"

namespace tetwarp {

void TwoLevelStart::set(const SoftProblem& problem,
                        const CompliantLists& lists,
                        RestFactors& factors) {
  time_step = problem.laws.adhesion.time_step;
  contacts.clear();
  for (const std::int32_t c : problem.contacts) contacts.push_back(problem.sides[index_of(c)]);
  laws.set(problem.laws);
  offset = problem.laws.velocity_offset;
  impulse = problem.laws.impulse_guess;
  for (std::size_t c = 0; c < laws.preload.size(); ++c) impulse[3 * c] += laws.preload[c];
  change.clear();
  for (std::size_t row = 0; row < lists.model_block.size() && !problem.change.empty(); ++row) {
    const Point3& own = problem.change[index_of(lists.model_block[row])];
    change.insert(change.end(), own.begin(), own.end());
  }
  factors.set_time_step(time_step);
  rotation.clear();
  for (const std::int32_t body : lists.model_body) {
    const auto own = factors.of_body(body).mean_rotation(problem.state.position.front().data());
    rotation.insert(rotation.end(), own.begin(), own.end());
  }
}

void TwoLevelStart::finish(const CompliantLists& lists,
                           std::span<const double> of_rows,
                           std::vector<double>& impulse,
                           std::vector<Point3>& velocity) const {
  for (std::size_t c = 0; c < laws.preload.size(); ++c) impulse[3 * c] -= laws.preload[c];
  for (std::size_t row = 0; row < lists.model_block.size(); ++row) {
    Point3& own = velocity[index_of(lists.model_block[row])];
    for (std::size_t i = 0; i < 3; ++i) own[i] = of_rows[3 * row + i];
  }
}

}  // namespace tetwarp
