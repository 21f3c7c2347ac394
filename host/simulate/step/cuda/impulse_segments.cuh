/// @file impulse_segments.cuh
/// ImpulseSegments: which terms of StepImpulseOp are summed together.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "host/simulate/model/model.hpp"
#include "kernels/exec/grid_sum.cuh"

namespace tetwarp {

/// The terms of StepImpulseOp in segments: bodies, then obstacles, then groups of springs.
class ImpulseSegments {
 public:
  explicit ImpulseSegments(const Model& model);

  struct SpringGroup {
    std::int32_t coupling, handle;  ///< one of them is -1
    std::int32_t body_a, body_b;
  };
  std::vector<SumRun> runs;      ///< of terms, at most sum_run each
  std::vector<SumRun> segments;  ///< of runs
  std::int64_t body_count = 0;   ///< segments before those of springs
  std::vector<SpringGroup> groups;

 private:
  void add_runs(std::int64_t begin, std::int64_t end) {
    for (; begin < end; begin += sum_run) runs.push_back({begin, std::min(begin + sum_run, end)});
  }
  void end_segment() {
    const std::int64_t begin = segments.empty() ? 0 : segments.back().end;
    segments.push_back({begin, static_cast<std::int64_t>(runs.size())});
  }
};

inline ImpulseSegments::ImpulseSegments(const Model& model) {
  const auto bodies = static_cast<std::int32_t>(model.body_node.size()) - 1;
  std::int32_t last = bodies - 1;
  for (const std::int32_t body : model.rigid.body) last = std::max(last, body);
  body_count = last + 1;
  std::vector<std::vector<std::int64_t>> rigid(static_cast<std::size_t>(body_count));
  for (std::size_t r = 0; r < model.rigid.body.size(); ++r) {
    rigid[static_cast<std::size_t>(model.rigid.body[r])].push_back(model.node_count +
                                                                   static_cast<std::int64_t>(r));
  }
  for (std::int32_t b = 0; b < body_count; ++b) {
    const auto body = static_cast<std::size_t>(b);
    if (b < bodies) add_runs(model.body_node[body], model.body_node[body + 1]);
    for (const std::int64_t term : rigid[body]) add_runs(term, term + 1);
    end_segment();
  }
  const ModelSprings& springs = model.springs;
  const std::int64_t first = model.node_count + std::int64_t{model.rigid_count};
  const auto group_of = [&](std::size_t s) {
    return SpringGroup{springs.coupling[s], springs.handle[s], springs.a[s].body,
                       springs.b[s].body};
  };
  const auto is_same = [](const SpringGroup& x, const SpringGroup& y) {
    return x.coupling == y.coupling && x.handle == y.handle && x.body_a == y.body_a &&
           x.body_b == y.body_b;
  };
  for (std::size_t s = 0; s < springs.a.size();) {
    groups.push_back(group_of(s));
    const auto begin = static_cast<std::int64_t>(s);
    while (s < springs.a.size() && is_same(group_of(s), groups.back())) ++s;
    add_runs(first + begin, first + static_cast<std::int64_t>(s));
    end_segment();
  }
}

}  // namespace tetwarp
