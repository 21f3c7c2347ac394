/// @file elastic_space.cpp
/// Lists touched nodes, and computes columns of their inverses at rest.
#include "host/simulate/solve/two_level/elastic_space.hpp"

#include <algorithm>
#include <iterator>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"

namespace tetwarp {
namespace {

constexpr std::size_t most_touched = 400;  // nodes of a body

}  // namespace

ElasticSpace::ElasticSpace(std::shared_ptr<RestFactors> factors) : factors_(std::move(factors)) {}

void ElasticSpace::find_bare(const SoftProblem& problem,
                             const std::vector<std::int32_t>& body_of,
                             std::vector<std::uint8_t>& bare) {
  std::vector<std::size_t> touched(bare.size(), 0);
  std::vector<std::uint8_t> is_counted(body_of.size(), 0);
  for (const std::int32_t contact : problem.contacts) {
    for (const std::int32_t block : problem.rows.blocks_of(index_of(contact))) {
      const std::int32_t body = body_of[index_of(block)];
      if (body < 0 || problem.islands.of_block(block) < 0 || is_counted[index_of(block)] != 0) {
        continue;
      }
      is_counted[index_of(block)] = 1;
      ++touched[index_of(body)];
    }
  }
  std::ranges::transform(touched, bare.begin(), [](std::size_t count) -> std::uint8_t {
    return count > most_touched ? 1 : 0;
  });
}

void ElasticSpace::set_bodies(const CompliantLists& lists,
                              const ContactRows& contact_rows,
                              const std::vector<std::int32_t>& contacts) {
  lists_ = &lists;
  slot_of_row_.assign(index_of(lists.row_count()), -1);
  for (const std::int32_t contact : contacts) {
    for (const std::int32_t block : contact_rows.blocks_of(index_of(contact))) {
      const std::int32_t row = lists.row_of_block[index_of(block)];
      if (row >= 0) slot_of_row_[index_of(row)] = 0;
    }
  }
  bodies_.resize(lists.model_body.size());
  for (const CompliantBody& body : lists.bodies) {
    if (body.frame < 0) continue;
    ElasticBody& own = bodies_[index_of(body.frame)];
    own.body = lists.model_body[index_of(body.frame)];
    own.row_begin = body.first;
    own.row_end = body.first + body.count;
    needed_.clear();
    for (std::int32_t row = own.row_begin; row < own.row_end; ++row) {
      if (slot_of_row_[index_of(row)] == 0) needed_.push_back(row - own.row_begin);
    }
    set_touched(own);
    for (std::size_t k = 0; k < own.touched.size(); ++k) {
      slot_of_row_[index_of(own.row_begin + own.touched[k])] = static_cast<std::int32_t>(k);
    }
  }
}

/// Sets the touched nodes: those that are needed and, if these are not many more, those of the
/// present compliance, which then stays the same where contacts come and go. Nodes that are not
/// needed change no result.
void ElasticSpace::set_touched(ElasticBody& own) const {
  own.touched.clear();
  if (own.source.body == own.body) {
    std::ranges::set_union(own.source.touched, needed_, std::back_inserter(own.touched));
  }
  const std::size_t most = std::min(most_touched, needed_.size() + needed_.size() / 4);
  if (own.source.body != own.body || own.touched.size() > most) own.touched = needed_;
}

void ElasticSpace::set(const TwoLevelStart& start, double damping, int threads) {
  damping_ = damping;
  size_ = 0;
  for (ElasticBody& own : bodies_) {
    own.first = 3 * lists_->row_count() + size_;
    own.size = (3 * static_cast<std::int64_t>(own.touched.size()) + 7) / 8 * 8;
    size_ += own.size;
  }
  parallel_tasks(threads, static_cast<std::int64_t>(bodies_.size()), [&](std::int64_t b) {
    ElasticBody& own = bodies_[index_of(b)];
    own.factor = &factors_->of_body(own.body);
    std::copy_n(start.rotation.begin() + 9 * b, 9, own.rotation.begin());
    set_compliance(own, start.time_step);
  });
}

void ElasticSpace::set_compliance(ElasticBody& own, double time_step) const {
  ElasticBody::Source& source = own.source;
  if (source.body == own.body && source.time_step == time_step && source.damping == damping_ &&
      source.touched == own.touched) {
    return;
  }
  source = {own.body, time_step, damping_, own.touched};
  RestFactor* const factor = own.factor;
  own.compliance.assign(index_of(own.size) * 3 * own.touched.size(), 0);
  float* out = own.compliance.data();
  for (const std::int32_t node : own.touched) {
    const float* column = factor->columns(node);
    for (int i = 0; i < 3; ++i, out += own.size, column += 3 * factor->node_count()) {
      for (std::size_t k = 0; k < own.touched.size(); ++k) {
        for (int e = 0; e < 3; ++e) {
          out[3 * k + index_of(e)] = static_cast<float>(damping_) * column[3 * own.touched[k] + e];
        }
      }
    }
  }
}

void ElasticSpace::solve(std::size_t body, const double* push, double* out) {
  ElasticBody& own = bodies_[body];
  own.factor->solve_turned(own.rotation, push, out);
  if (damping_ == 1) return;
  for (std::int64_t k = 0; k < 3 * std::int64_t{own.row_end - own.row_begin}; ++k) {
    out[k] *= damping_;
  }
}

void ElasticSpace::gather(std::size_t body, const double* rows, double* y) const {
  const ElasticBody& own = bodies_[body];
  const auto& r = own.rotation;
  for (std::size_t k = 0; k < own.touched.size(); ++k) {
    const double* const v = rows + 3 * (own.row_begin + own.touched[k]);
    double* const out = y + own.first + 3 * static_cast<std::int64_t>(k);
    for (std::size_t i = 0; i < 3; ++i) out[i] = r[i] * v[0] + r[3 + i] * v[1] + r[6 + i] * v[2];
  }
}

}  // namespace tetwarp
