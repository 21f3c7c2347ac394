/// @file elastic_groups.cpp
/// Sorts contacts into groups, and changes the velocities of their bodies by sums of pushes.
#include "host/simulate/solve/two_level/elastic_groups.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {
namespace {

// Larger groups touch so many nodes of their bodies that all velocities follow every impulse.
constexpr std::size_t most_of_part = 150;  // contacts
constexpr std::int64_t piece_size = 160;   // numbers of a body, a multiple of 8

}  // namespace

void ElasticGroups::set(const ElasticSpace& space,
                        const std::vector<std::int32_t>& block_start,
                        const std::vector<std::int32_t>& block_row) {
  space_ = &space;
  block_start_ = &block_start;
  block_row_ = &block_row;
  groups_.clear();
  group_of_bodies_.clear();
  group_of_.assign(block_start.size() - 1, -1);
  place_of_block_.assign(block_row.size(), -1);
}

/// A contact has two sides, each on one body at most. @returns these, or -1
std::array<std::int32_t, 2> ElasticGroups::bodies_of(std::int32_t contact) const {
  std::array<std::int32_t, 2> own{-1, -1};
  const std::int32_t end = (*block_start_)[index_of(contact) + 1];
  for (std::int32_t p = (*block_start_)[index_of(contact)]; p < end; ++p) {
    const std::int32_t body = space_->body_of_row((*block_row_)[index_of(p)]);
    if (body >= 0 && body != own[0]) own[own[0] < 0 ? 0 : 1] = body;
  }
  if (own[1] >= 0 && own[1] < own[0]) std::swap(own[0], own[1]);
  return own;
}

const std::vector<std::int32_t>& ElasticGroups::group(std::vector<std::int32_t>& list,
                                                      int threads) {
  changed_.clear();
  for (const std::int32_t contact : list) {
    if (group_of_[index_of(contact)] >= 0) continue;
    const auto [found, is_new] = group_of_bodies_.try_emplace(bodies_of(contact), count());
    if (is_new) groups_.push_back({});
    group_of_[index_of(contact)] = found->second;
    groups_[index_of(found->second)].contacts.push_back(contact);
    changed_.push_back(found->second);
  }
  std::ranges::sort(changed_);
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  parallel_tasks(threads, static_cast<std::int64_t>(changed_.size()), [this](std::int64_t k) {
    Group& own = groups_[index_of(changed_[index_of(k)])];
    std::ranges::sort(own.contacts);
    own = Group{std::move(own.contacts)};
    list_slots(own);
  });
  std::ranges::sort(list, {}, [&](std::int32_t contact) {
    return std::pair(group_of_[index_of(contact)], contact);
  });
  return changed_;
}

/// Nodes that contacts of one group touch, and the places of their blocks.
void ElasticGroups::list_slots(Group& group) {
  const auto for_blocks = [&](const auto& visit) {
    for (const std::int32_t contact : group.contacts) {
      const std::int32_t end = (*block_start_)[index_of(contact) + 1];
      for (std::int32_t p = (*block_start_)[index_of(contact)]; p < end; ++p) {
        const std::int32_t row = (*block_row_)[index_of(p)];
        const std::int32_t body = space_->body_of_row(row);
        if (body >= 0) {
          visit(index_of(p), body, space_->slot_of_row(row));
        } else {
          group.is_pure = false;
        }
      }
    }
  };
  const auto body_at = [&](std::int32_t body) {
    return std::ranges::find(group.bodies, body, &Body::body);
  };
  for_blocks([&](std::size_t, std::int32_t body, std::int32_t slot) {
    auto own = body_at(body);
    if (own == group.bodies.end()) own = group.bodies.insert(own, Body{body, 0, 0, {}});
    own->slots.push_back(slot);
  });
  group.is_whole = group.contacts.size() > most_of_part;
  for (Body& own : group.bodies) {
    if (group.is_whole) {
      own.slots.resize(space_->bodies()[index_of(own.body)].touched.size());
      std::iota(own.slots.begin(), own.slots.end(), 0);
    } else {
      std::sort(own.slots.begin(), own.slots.end());
      own.slots.erase(std::unique(own.slots.begin(), own.slots.end()), own.slots.end());
    }
    own.first = group.size;
    own.size = (3 * static_cast<std::int32_t>(own.slots.size()) + 7) / 8 * 8;
    group.size += own.size;
  }
  for_blocks([&](std::size_t p, std::int32_t body, std::int32_t slot) {
    const Body& own = *body_at(body);
    const auto place = std::lower_bound(own.slots.begin(), own.slots.end(), slot);
    place_of_block_[p] = own.first + 3 * static_cast<std::int32_t>(place - own.slots.begin());
  });
  group.z.resize(index_of(group.size));
  group.push.resize(index_of(group.size));
}

void ElasticGroups::copy_compliance(Body& own) const {
  const ElasticBody& body = space_->bodies()[index_of(own.body)];
  own.compliance.assign(3 * own.slots.size() * index_of(own.size), 0);
  float* out = own.compliance.data();
  for (const std::int32_t slot : own.slots) {
    for (std::int64_t i = 0; i < 3; ++i, out += own.size) {
      const float* const column = body.compliance.data() + (3 * std::int64_t{slot} + i) * body.size;
      for (std::size_t k = 0; k < own.slots.size(); ++k) {
        std::copy_n(column + 3 * std::int64_t{own.slots[k]}, 3, out + 3 * k);
      }
    }
  }
}

void ElasticGroups::add_velocities(std::int32_t group,
                                   std::int32_t place,
                                   const float* push,
                                   float* z) {
  Group& all = groups_[index_of(group)];
  for (Body& own : all.bodies) {
    if (place < own.first || place >= own.first + own.size) continue;
    if (!all.is_whole && own.compliance.empty()) copy_compliance(own);
    const float* const compliance =
        (all.is_whole ? space_->bodies()[index_of(own.body)].compliance : own.compliance).data();
    const std::int64_t column = std::int64_t{place} - own.first;
    vector_stages().add_rows_float(compliance + column * own.size, own.size, push, own.size,
                                   z + own.first);
  }
}

void ElasticGroups::begin(std::int32_t group, const double* y) {
  Group& all = groups_[index_of(group)];
  for (const Body& own : all.bodies) {
    const double* const from = y + space_->bodies()[index_of(own.body)].first;
    double* out = all.z.data() + own.first;
    for (const std::int32_t slot : own.slots) {
      const double* const v = from + 3 * std::int64_t{slot};
      out[0] = v[0], out[1] = v[1], out[2] = v[2];
      out += 3;
    }
  }
  std::ranges::fill(all.push, 0.0);
}

/// finish() for a piece of one body of a group.
std::int64_t ElasticGroups::finish(const Group& group,
                                   const Body& own,
                                   const Piece& piece,
                                   double* y) const {
  const ElasticBody& body = space_->bodies()[index_of(own.body)];
  const std::int64_t size = piece.end - piece.begin;
  double* const out = y + body.first + piece.begin;
  if (group.is_whole) {
    std::copy_n(group.z.data() + own.first + piece.begin, size, out);
    return 0;
  }
  std::int64_t operations = 0;
  const double* push = group.push.data() + own.first;
  for (const std::int32_t slot : own.slots) {
    if (push[0] != 0 || push[1] != 0 || push[2] != 0) {
      const float* const columns =
          body.compliance.data() + 3 * std::int64_t{slot} * body.size + piece.begin;
      vector_stages().add_rows(columns, body.size, push, size, out);
      operations += 3 * size;
    }
    push += 3;
  }
  return operations;
}

std::int64_t ElasticGroups::finish(std::span<const std::int32_t> groups, double* y, int threads) {
  finished_.clear();
  for (const std::int32_t group : groups) {
    for (const Body& own : groups_[index_of(group)].bodies) {
      const std::int64_t size = space_->bodies()[index_of(own.body)].size;
      for (std::int64_t begin = 0; begin < size; begin += piece_size) {
        finished_.push_back({own.body, begin, std::min(begin + piece_size, size)});
      }
    }
  }
  std::ranges::sort(finished_);
  finished_.erase(std::unique(finished_.begin(), finished_.end()), finished_.end());
  std::atomic<std::int64_t> operations = 0;
  parallel_tasks(threads, static_cast<std::int64_t>(finished_.size()), [&](std::int64_t k) {
    const Piece& piece = finished_[index_of(k)];
    for (const std::int32_t group : groups) {
      const Group& all = groups_[index_of(group)];
      for (const Body& own : all.bodies) {
        if (own.body == piece.body) operations += finish(all, own, piece, y);
      }
    }
  });
  return operations;
}

}  // namespace tetwarp
