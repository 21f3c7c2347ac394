/// @file condensed_choice.cpp
/// Counts what condensing costs.
#include "host/simulate/solve/condensed/condensed_choice.hpp"

#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t most_rows = 2048;  // of a contact island

}  // namespace

/// Rows, contacts and kinds of contact islands.
void CondensedChoice::find_kinds(const SystemIslands& places,
                                 const ContactProblem& laws,
                                 const ContactShare& share) {
  costs_.assign(index_of(islands_.count()), {});
  for (std::int32_t i = 0; i < islands_.count(); ++i) {
    if (share.islands[index_of(i)] == 0) continue;
    Cost& cost = cost_of(i);
    cost.rows += places.of(i).end - places.of(i).begin;
    const bool is_single = factors_.bodies_of_island(i).size() == 1;
    cost.has_joined = cost.has_joined || (islands_.is_coupled(i) && !is_single);
    cost.has_elastic = cost.has_elastic || factors_.has_any(i);
  }
  for (const std::int32_t c : share.contacts) {
    Cost& cost = cost_of(islands_.of_contact()[index_of(c)]);
    ++cost.contacts;
    cost.has_friction = cost.has_friction || laws.friction[index_of(c)] > 0;
  }
}

/// Contacts of coupling islands that may be taken, and their blocks.
void CondensedChoice::find_touches(const SystemIslands& places,
                                   const ContactRows& rows,
                                   const ContactShare& share) {
  touches_.assign(costs_.size(), {});
  for (const std::int32_t c : share.contacts) {
    if (!takes(islands_.of_contact()[index_of(c)])) continue;
    for (const std::int32_t block : rows.blocks_of(index_of(c))) {
      const std::int32_t row = places.row_of_block()[index_of(block)];
      if (row < 0) continue;
      Touch& own = touches_[index_of(places.of_row(row))];
      ++own.blocks;
      if (own.last != c) ++own.contacts;
      own.last = c;
    }
  }
}

void CondensedChoice::find(const Limits& limits,
                           const SystemRows& system,
                           const SystemIslands& places,
                           std::vector<CondensedIsland>& coupling,
                           const ContactRows& rows,
                           const ContactProblem& laws,
                           const ContactShare& share) {
  find_kinds(places, laws, share);
  for (Cost& cost : costs_) {
    cost.is_taken = cost.has_joined && (cost.has_friction || cost.has_elastic) &&
                    cost.rows <= most_rows && cost.contacts > 0 && cost.contacts <= limits.contacts;
  }
  find_touches(places, rows, share);
  for (std::int32_t i = 0; i < islands_.count(); ++i) {
    if (share.islands[index_of(i)] == 0 || !takes(i)) continue;
    const RowRangeLu& lu = coupling[index_of(i)].pattern(system);
    const Touch& own = touches_[index_of(i)];
    Cost& cost = cost_of(i);
    // Of W half of the 3x3 blocks are products, of nine numbers of J with three columns each.
    cost.operations += lu.operations() + 3 * own.contacts * lu.solve_operations() +
                       27 * own.blocks * (own.contacts + 1) / 2;
    cost.is_taken = cost.operations <= limits.operations;
  }
}

}  // namespace tetwarp
