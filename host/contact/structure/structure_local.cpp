/// @file structure_local.cpp
/// Structure of a problem in local form, which is given by its Delassus matrix.
#include "host/contact/structure/structure_local.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "host/contact/structure/structure_parts.hpp"

namespace tetwarp {

void fill_local_structure(const ContactProblem& problem,
                          const ContactSkipOptions& skip,
                          StructureStages& stages,
                          ContactStructure& structure) {
  ContactStructure& s = structure;
  const SparseMatrix& w = problem.delassus;
  const std::int64_t contacts = problem.contact_count();
  const auto contact_of = [](std::int32_t column) { return column / 3; };
  const Lists rows = block_columns(w, contact_rows(contacts), contacts, contact_of, true);

  // Two contacts that W couples, in either direction, are a group.
  std::vector<std::pair<std::int32_t, std::int32_t>> couplings;
  for (std::int64_t c = 0; c < contacts; ++c) {
    for (const std::int32_t other : rows.of(c)) {
      const auto own = static_cast<std::int32_t>(c);
      if (other != own) couplings.emplace_back(std::min(own, other), std::max(own, other));
    }
  }
  std::sort(couplings.begin(), couplings.end());
  couplings.erase(std::unique(couplings.begin(), couplings.end()), couplings.end());
  Lists groups;
  for (const auto& [a, b] : couplings) {
    groups.item.insert(groups.item.end(), {a, b});
    groups.close_list();
  }
  const std::vector<std::int32_t> islands = skip.converged_islands
                                                ? components_of(groups, contacts, stages)
                                                : std::vector<std::int32_t>(index_of(contacts), 0);
  take_order(s, make_contact_order(make_transposed(groups, contacts), islands));

  const std::vector<std::int32_t> slot_of = places_of(s.contact_of_slot);
  s.delassus_row = {0};
  s.delassus_target.resize(w.value.size());
  std::vector<std::int32_t> columns;
  for (std::size_t slot = 0; slot < s.contact_of_slot.size(); ++slot) {
    const std::int64_t c = s.contact_of_slot[slot];
    columns.clear();
    for (const std::int32_t other : rows.of(c)) columns.push_back(slot_of[index_of(other)]);
    std::sort(columns.begin(), columns.end());
    const std::int64_t first = s.delassus_row.back();
    const auto place_of = [&](std::int32_t block) {
      return first + (std::lower_bound(columns.begin(), columns.end(), block) - columns.begin());
    };
    s.delassus_diagonal.push_back(place_of(static_cast<std::int32_t>(slot)));
    for (std::int64_t a = 0; a < 3; ++a) {
      const std::int64_t last = w.row_start[index_of(3 * c + a + 1)];
      for (std::int64_t e = w.row_start[index_of(3 * c + a)]; e < last; ++e) {
        const std::int32_t column = w.column[index_of(e)];
        s.delassus_target[index_of(e)] =
            9 * place_of(slot_of[index_of(column / 3)]) + 3 * a + column % 3;
      }
    }
    s.delassus_column.insert(s.delassus_column.end(), columns.begin(), columns.end());
    s.delassus_row.push_back(static_cast<std::int64_t>(s.delassus_column.size()));
  }
}

/// All contacts in one island, each with its own color.
void fill_dense_structure(std::int64_t contacts, ContactStructure& s) {
  ContactIsland island;
  island.slot_end = contacts;
  island.color_end = contacts + 1;
  s.islands = {island};
  s.contact_islands = 1;
  s.contact_of_slot.resize(index_of(contacts));
  std::iota(s.contact_of_slot.begin(), s.contact_of_slot.end(), 0);
  s.color_start.resize(index_of(contacts) + 1);
  std::iota(s.color_start.begin(), s.color_start.end(), 0);
  s.delassus_row = {0};
  s.delassus_column.reserve(index_of(contacts * contacts));
  for (std::int64_t c = 0; c < contacts; ++c) {
    s.delassus_column.insert(s.delassus_column.end(), s.contact_of_slot.begin(),
                             s.contact_of_slot.end());
    s.delassus_row.push_back((c + 1) * contacts);
    s.delassus_diagonal.push_back(c * contacts + c);
  }
}

}  // namespace tetwarp
