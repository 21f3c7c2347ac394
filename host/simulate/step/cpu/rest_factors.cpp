/// @file rest_factors.cpp
/// Makes factors when a length of a step is new.
#include "host/simulate/step/cpu/rest_factors.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {

constexpr std::size_t most_time_steps = 3;  // whose factors are kept

}  // namespace

RestFactors::RestFactors(const Model& model)
    : model_(model), body_of_island_(index_of(model.island_count), -1) {
  std::vector<std::int32_t> bodies(index_of(model.island_count), 0);
  for (std::size_t body = 0; body < model.body_island.size(); ++body) {
    const std::int32_t island = model.body_island[body];
    if (island < 0) continue;
    const auto own = static_cast<std::int32_t>(body);
    ++bodies[index_of(island)];
    body_of_island_[index_of(island)] = RestFactor::is_possible(model, own) ? own : -1;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i] > 1) body_of_island_[i] = -1;
  }
}

void RestFactors::set_time_step(double time_step) {
  const auto found = std::ranges::find(factors_, time_step, &Factors::time_step);
  selected_ = static_cast<std::size_t>(found - factors_.begin());
  if (found != factors_.end()) return;
  if (factors_.size() == most_time_steps) factors_.erase(factors_.begin());
  factors_.push_back({time_step, {}});
  factors_.back().of_body.resize(model_.body_island.size());
  selected_ = factors_.size() - 1;
}

RestFactor& RestFactors::of_body(std::int32_t body) {
  std::unique_ptr<RestFactor>& own = factors_[selected_].of_body[index_of(body)];
  if (!own) own = std::make_unique<RestFactor>(model_, body, factors_[selected_].time_step);
  return *own;
}

}  // namespace tetwarp
