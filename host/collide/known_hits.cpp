/// @file known_hits.cpp
/// Sorted lists of hits.
#include "host/collide/known_hits.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>

#include "host/base/point3.hpp"
#include "host/collide/pair_bodies.hpp"

namespace tetwarp {
namespace {
bool is_before(const FeatureTouch& p, const FeatureTouch& q) {
  return std::tie(p.pair.kind, p.pair.a, p.pair.b) < std::tie(q.pair.kind, q.pair.a, q.pair.b);
}
}  // namespace

const std::vector<FeatureTouch>& KnownHits::add(View<const FeatureTouch> hits) {
  last_.assign(hits.data, hits.data + hits.size);
  std::sort(last_.begin(), last_.end(), is_before);
  results_.clear();
  std::set_difference(last_.begin(), last_.end(), known_.begin(), known_.end(),
                      std::back_inserter(results_), is_before);
  const auto middle = static_cast<std::ptrdiff_t>(known_.size());
  known_.insert(known_.end(), results_.begin(), results_.end());
  std::inplace_merge(known_.begin(), known_.begin() + middle, known_.end(), is_before);
  return results_;
}

const std::vector<FeatureTouch>& KnownHits::of_rigid_bodies() {
  results_.clear();
  std::ranges::copy_if(last_, std::back_inserter(results_), [this](const FeatureTouch& touch) {
    return std::ranges::all_of(bodies_of(touch.pair, surfaces_), [this](std::int32_t body) {
      return at(surfaces_.bodies, body).is_rigid;
    });
  });
  return results_;
}

}  // namespace tetwarp
