/// @file elastic_space.cpp
/// Chooses bodies, and computes columns of their inverses at rest.
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

void ElasticSpace::choose(const SystemRows& rows,
                          const ContactIslands& islands,
                          const std::vector<std::uint8_t>& takes,
                          const ContactRows& contact_rows,
                          const std::vector<std::int32_t>& contacts) {
  body_of_row_.assign(index_of(rows.unknown_count), -1);
  slot_of_row_.assign(index_of(rows.unknown_count), -1);
  row_of_block_.assign(index_of(rows.block_of.size), -1);
  std::size_t count = 0;
  std::int32_t last = -1;
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    const std::int32_t island = islands.of_block(rows.block_of[row]);
    if (takes[index_of(island)] == 0 || factors_->body_of_island(island) < 0) continue;
    if (island != last) {
      if (count == bodies_.size()) bodies_.emplace_back();
      bodies_[count].body = factors_->body_of_island(island);
      bodies_[count].row_begin = row;
      ++count;
      last = island;
    }
    bodies_[count - 1].row_end = row + 1;
    body_of_row_[index_of(row)] = static_cast<std::int32_t>(count) - 1;
    row_of_block_[index_of(rows.block_of[row])] = row;
  }
  bodies_.resize(count);
  for (const std::int32_t contact : contacts) {
    for (const std::int32_t block : contact_rows.blocks_of(index_of(contact))) {
      const std::int32_t row = row_of_block_[index_of(block)];
      if (row >= 0) slot_of_row_[index_of(row)] = 0;
    }
  }
  for (ElasticBody& own : bodies_) {
    needed_.clear();
    for (std::int32_t row = own.row_begin; row < own.row_end; ++row) {
      if (slot_of_row_[index_of(row)] == 0) needed_.push_back(row - own.row_begin);
    }
    set_touched(own);
    for (std::size_t k = 0; k < own.touched.size(); ++k) {
      slot_of_row_[index_of(own.row_begin + own.touched[k])] = static_cast<std::int32_t>(k);
    }
  }
  const auto is_left = [&](const ElasticBody& own) {
    if (own.touched.size() <= most_touched) return false;
    for (std::int32_t row = own.row_begin; row < own.row_end; ++row)
      body_of_row_[index_of(row)] = -1;
    return true;
  };
  bodies_.erase(std::remove_if(bodies_.begin(), bodies_.end(), is_left), bodies_.end());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::int32_t row = bodies_[b].row_begin; row < bodies_[b].row_end; ++row) {
      body_of_row_[index_of(row)] = static_cast<std::int32_t>(b);
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

void ElasticSpace::set(
    const ModelState& state, double time_step, std::int64_t first, double damping, int threads) {
  damping_ = damping;
  size_ = 0;
  for (ElasticBody& own : bodies_) {
    own.first = first + size_;
    own.size = (3 * static_cast<std::int64_t>(own.touched.size()) + 7) / 8 * 8;
    size_ += own.size;
  }
  if (bodies_.empty()) return;
  factors_->set_time_step(time_step);
  parallel_tasks(threads, static_cast<std::int64_t>(bodies_.size()), [&](std::int64_t b) {
    ElasticBody& own = bodies_[index_of(b)];
    own.factor = &factors_->of_body(own.body);
    own.rotation = own.factor->mean_rotation(state.position.front().data());
    set_compliance(own, time_step);
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
