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
    : model_(model),
      has_(model.body_island.size(), 0),
      has_any_(index_of(model.island_count), 0),
      bodies_of_island_(index_of(model.island_count)) {
  std::vector<std::uint8_t> has_other(index_of(model.island_count), 0);
  for (std::size_t b = 0; b < has_.size(); ++b) {
    const std::int32_t island = model.body_island[b];
    if (island < 0) continue;
    const auto body = static_cast<std::int32_t>(b);
    has_[b] = RestFactor::is_possible(model, body) ? 1 : 0;
    bodies_of_island_[index_of(island)].push_back(body);
    (has(body) ? has_any_ : has_other)[index_of(island)] = 1;
  }
  for (std::size_t i = 0; i < has_other.size(); ++i) {
    if (has_other[i] != 0) bodies_of_island_[i].clear();
  }
}

std::vector<std::int32_t> RestFactors::bodies_of_blocks() const {
  std::vector<std::int32_t> body_of(index_of(model_.block_count()), -1);
  for (std::size_t b = 0; b < has_.size(); ++b) {
    const auto body = static_cast<std::int32_t>(b);
    if (!has(body)) continue;
    std::fill(body_of.begin() + model_.body_node[b], body_of.begin() + model_.body_node[b + 1],
              body);
  }
  return body_of;
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
