/// @file condensed_solver.cpp
/// Counts what condensing costs, makes the matrix of contacts, and takes the solution back.
#include "host/simulate/solve/condensed_solver.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/index_of.hpp"
#include "host/simulate/solve/problem/contact_laws.hpp"
#include "host/simulate/step/cpu/island_factors.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t most_rows = 2048;  // of a contact island

ContactOptions on_host(ContactOptions options) {
  options.backend = Backend::cpu;
  return options;
}

}  // namespace

CondensedSolver::CondensedSolver(const ContactOptions& options) : solver_(on_host(options)) {}

template <class Visit>
void CondensedSolver::for_rows(const ContactRows& rows,
                               std::int32_t contact,
                               const Visit& visit) const {
  for (std::int32_t e = rows.start[index_of(contact)]; e < rows.start[index_of(contact) + 1]; ++e) {
    const std::int32_t row = row_of_block_[index_of(rows.block[index_of(e)])];
    if (row >= 0) visit(island_of_row_[index_of(row)], row, rows.value[index_of(e)].data());
  }
}

/// Rows of an island follow each other.
void CondensedSolver::find_rows(const SystemRows& system, const ContactIslands& islands) {
  islands_.resize(index_of(islands.count()));
  for (Island& island : islands_) island.begin = island.end = 0;
  island_of_row_.resize(index_of(system.unknown_count));
  row_of_block_.assign(index_of(system.count), -1);
  for (std::int32_t row = 0; row < system.unknown_count; ++row) {
    const std::int32_t block = system.block_of[row];
    Island& own = islands_[index_of(islands.of_block(block))];
    if (own.end == 0) own.begin = row;
    own.end = row + 1;
    island_of_row_[index_of(row)] = islands.of_block(block);
    row_of_block_[index_of(block)] = row;
  }
}

/// Counts rows and contacts of contact islands, at their roots.
void CondensedSolver::find_kinds(const ContactIslands& islands,
                                 const ContactProblem& laws,
                                 const RestFactors& factors,
                                 const ContactShare& share) {
  costs_.assign(islands_.size(), {});
  for (std::int32_t i = 0; i < islands.count(); ++i) {
    if (share.islands[index_of(i)] == 0) continue;
    Cost& cost = costs_[index_of(islands.root(i))];
    cost.rows += islands_[index_of(i)].end - islands_[index_of(i)].begin;
    const bool is_single = factors.bodies_of_island(i).size() == 1;
    cost.has_joined = cost.has_joined || (islands.is_coupled(i) && !is_single);
    cost.has_elastic = cost.has_elastic || factors.has_any(i);
  }
  for (const std::int32_t c : share.contacts) {
    Cost& cost = costs_[index_of(islands.root(islands.of_contact()[index_of(c)]))];
    ++cost.contacts;
    cost.has_friction = cost.has_friction || laws.friction[index_of(c)] > 0;
  }
}

/// Patterns are set only for contact islands of few rows and contacts.
void CondensedSolver::find_costs(const Limits& limits,
                                 const SystemRows& system,
                                 const ContactIslands& islands,
                                 const ContactRows& rows,
                                 const ContactShare& share) {
  for (Cost& cost : costs_) {
    const bool is_possible = cost.has_joined && (cost.has_friction || cost.has_elastic) &&
                             cost.rows <= most_rows && cost.contacts > 0 &&
                             cost.contacts <= limits.contacts;
    cost.operations = is_possible ? 0 : limits.operations + 1;
  }
  const auto cost_of = [&](std::int32_t island) -> Cost& {
    return costs_[index_of(islands.root(island))];
  };
  for (std::int32_t i = 0; i < islands.count(); ++i) {
    Island& own = islands_[index_of(i)];
    if (share.islands[index_of(i)] == 0 || cost_of(i).operations > limits.operations) continue;
    own.lu.set(system, own.begin, own.end);
    cost_of(i).operations += own.lu.operations();
  }
  for (const std::int32_t c : share.contacts) {
    if (cost_of(islands.of_contact()[index_of(c)]).operations > limits.operations) continue;
    std::int32_t last = -1;
    for_rows(rows, c, [&](std::int32_t island, std::int32_t, const double*) {
      if (island != last) {
        cost_of(island).operations += 3 * islands_[index_of(island)].lu.solve_operations();
      }
      last = island;
    });
  }
}

void CondensedSolver::take(const Limits& limits,
                           const SystemRows& system,
                           const ContactIslands& islands,
                           const ContactRows& rows,
                           const ContactProblem& laws,
                           const RestFactors& factors,
                           ContactShare& from,
                           ContactShare& to) {
  to.clear(islands.count());
  find_rows(system, islands);
  find_kinds(islands, laws, factors, from);
  find_costs(limits, system, islands, rows, from);
  const auto is_taken = [&](std::int32_t island) {
    return costs_[index_of(islands.root(island))].operations <= limits.operations;
  };
  for (std::int32_t i = 0; i < islands.count(); ++i) {
    if (from.islands[index_of(i)] != 0 && is_taken(i)) {
      from.islands[index_of(i)] = 0;
      to.islands[index_of(i)] = 1;
    }
  }
  std::vector<std::int32_t> left;
  for (const std::int32_t c : from.contacts) {
    (is_taken(islands.of_contact()[index_of(c)]) ? to.contacts : left).push_back(c);
  }
  from.contacts = std::move(left);
}

/// Factors and columns are kept as long as A is the same, as it is in the passes of a step.
bool CondensedSolver::find_factors(const StepSystem& system, const ContactShare& share) {
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    Island& own = islands_[i];
    if (share.islands[i] == 0) continue;
    const double* const begin = system.values.data + 9 * std::int64_t{system.rows.start[own.begin]};
    const double* const end = system.values.data + 9 * std::int64_t{system.rows.start[own.end]};
    const bool is_same = std::equal(begin, end, own.values.begin(), own.values.end());
    if (!is_same) {
      own.values.assign(begin, end);
      own.rows.clear();
    }
    RowRangeLu* const made = system.factors != nullptr ? (*system.factors)[i].made() : nullptr;
    const bool is_kept = is_same && own.factors == &own.lu;
    own.factors = made != nullptr ? made : &own.lu;
    if (made != nullptr || is_kept) continue;
    if (!own.lu.factor(system.rows, system.values)) {
      own.values.clear();
      return false;
    }
  }
  return true;
}

void CondensedSolver::list_contacts(const ContactRows& rows, const ContactShare& share) {
  for (Island& island : islands_) {
    island.contacts.clear();
    std::swap(island.rows, island.kept_rows);
    std::swap(island.columns, island.kept_columns);
    island.rows.clear();
  }
  for (std::size_t k = 0; k < share.contacts.size(); ++k) {
    const auto place = static_cast<std::int32_t>(k);
    for_rows(rows, share.contacts[k], [&](std::int32_t island, std::int32_t row, const double* j) {
      Island& own = islands_[index_of(island)];
      if (own.contacts.empty() || own.contacts.back() != place) {
        own.contacts.push_back(place);
        own.rows.emplace_back();
      }
      own.rows.back().push_back(row);
      own.rows.back().insert(own.rows.back().end(), j, j + 9);
    });
  }
}

/// force_ = A^-1 force_ on the rows of the islands.
void CondensedSolver::find_velocities(const StepSystem& system, const ContactShare& share) {
  for (std::int32_t row = 0; row < system.rows.unknown_count; ++row) {
    if (share.islands[index_of(island_of_row_[index_of(row)])] == 0) continue;
    for (std::int64_t e = 3 * std::int64_t{row}; e < 3 * std::int64_t{row} + 3; ++e) {
      force_[index_of(e)] += system.load[e];
    }
  }
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    Island& own = islands_[i];
    if (share.islands[i] == 0) continue;
    own.factors->solve({force_.data() + 3 * own.begin, index_of(3 * (own.end - own.begin))});
  }
}

void CondensedSolver::find_columns(Island& island) const {
  const std::size_t size = 3 * index_of(island.end - island.begin);
  island.columns.assign(3 * island.contacts.size() * size, 0.0);
  double* column = island.columns.data();
  for (const std::vector<double>& own : island.rows) {
    const auto kept = std::ranges::find(island.kept_rows, own);
    if (kept != island.kept_rows.end()) {
      const auto from = island.kept_columns.begin() +
                        3 * static_cast<std::ptrdiff_t>(size) * (kept - island.kept_rows.begin());
      column = std::copy_n(from, 3 * size, column);
      continue;
    }
    for (std::size_t axis = 0; axis < 3; ++axis, column += size) {
      for (std::size_t e = 0; e < own.size(); e += 10) {
        const std::int64_t place = static_cast<std::int64_t>(own[e]) - island.begin;
        std::copy_n(own.begin() + static_cast<std::ptrdiff_t>(e + 1 + 3 * axis), 3,
                    column + 3 * place);
      }
      island.factors->solve({column, size});
    }
  }
}

void CondensedSolver::set_matrix(const ContactRows& rows, const ContactShare& share) {
  const std::size_t count = share.contacts.size();
  matrix_.assign(9 * count * count, 0.0);
  has_block_.assign(count * count, 0);
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    Island& own = islands_[i];
    if (share.islands[i] == 0 || own.contacts.empty()) continue;
    find_columns(own);
    const std::int64_t size = 3 * (own.end - own.begin);
    for (const std::int32_t d : own.contacts) {
      for (std::size_t k = 0; k < own.contacts.size(); ++k) {
        const std::size_t place = index_of(d) * count + index_of(own.contacts[k]);
        double* const block = matrix_.data() + 9 * place;
        has_block_[place] = 1;
        const double* const column = own.columns.data() + 3 * k * index_of(size);
        for_rows(rows, share.contacts[index_of(d)],
                 [&](std::int32_t island, std::int32_t row, const double* j) {
                   if (index_of(island) != i) return;
                   const double* const from = column + 3 * (row - own.begin);
                   for (int e = 0; e < 9; ++e) {
                     const double* const v = from + e % 3 * size;
                     const double* const along = j + e / 3 * 3;
                     block[e] += along[0] * v[0] + along[1] * v[1] + along[2] * v[2];
                   }
                 });
      }
    }
  }
}

/// Whether velocities are finite, and each contact gives way to its own impulses.
bool CondensedSolver::is_valid(std::size_t contact_count) const {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (!std::ranges::all_of(force_, is_finite) || !std::ranges::all_of(matrix_, is_finite)) {
    return false;
  }
  for (std::size_t c = 0; c < contact_count; ++c) {
    const double* const block = matrix_.data() + 9 * (c * contact_count + c);
    if (!(block[0] > 0 && block[4] > 0 && block[8] > 0)) return false;
  }
  return true;
}

/// u = W r + q with the impulses nu_n of the springs at u_n = 0 as part of r.
void CondensedSolver::set_problem(const ContactRows& rows,
                                  const ContactProblem& laws,
                                  const ContactShare& share) {
  const std::size_t count = share.contacts.size();
  gather_laws(share.contacts, laws, problem_);
  laws_.set(problem_);
  problem_.free_velocity = problem_.velocity_offset;
  problem_.velocity_offset.clear();
  SparseMatrix& w = problem_.delassus;
  w.rows = w.columns = static_cast<std::int64_t>(3 * count);
  w.row_start.assign(1, 0);
  w.column.clear();
  w.value.clear();
  for (std::size_t d = 0; d < count; ++d) {
    double* const free = problem_.free_velocity.data() + 3 * d;
    for_rows(rows, share.contacts[d], [&](std::int32_t, std::int32_t row, const double* j) {
      const double* const v = force_.data() + 3 * std::int64_t{row};
      for (int a = 0; a < 3; ++a) {
        free[a] += j[3 * a] * v[0] + j[3 * a + 1] * v[1] + j[3 * a + 2] * v[2];
      }
    });
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t c = 0; c < count; ++c) {
        if (has_block_[d * count + c] == 0) continue;
        const double* const block = matrix_.data() + 9 * (d * count + c) + 3 * a;
        free[a] -= block[0] * laws_.preload[c];
        for (std::size_t b = 0; b < 3; ++b) {
          w.column.push_back(static_cast<std::int32_t>(3 * c + b));
          w.value.push_back(block[b]);
        }
      }
      w.row_start.push_back(static_cast<std::int64_t>(w.column.size()));
    }
    problem_.impulse_guess[3 * d] += laws_.preload[d];
  }
}

const ContactReport* CondensedSolver::solve(const StepSystem& system,
                                            const ContactRows& rows,
                                            const ContactProblem& laws,
                                            const ContactShare& share,
                                            std::vector<Point3>& velocity) {
  if (!find_factors(system, share)) return nullptr;
  list_contacts(rows, share);
  force_.assign(3 * index_of(system.rows.unknown_count), 0.0);
  find_velocities(system, share);
  set_matrix(rows, share);
  if (!is_valid(share.contacts.size())) return nullptr;
  set_problem(rows, laws, share);
  try {
    solution_ = solver_.solve(problem_);
  } catch (const ContactProblemError&) {  // rounding has made W indefinite
    return nullptr;
  }
  std::ranges::fill(force_, 0.0);
  for (std::size_t c = 0; c < share.contacts.size(); ++c) {
    double* const r = solution_.impulse.data() + 3 * c;
    r[0] -= laws_.preload[c];
    for_rows(rows, share.contacts[c], [&](std::int32_t, std::int32_t row, const double* j) {
      double* const out = force_.data() + 3 * std::int64_t{row};
      for (int k = 0; k < 3; ++k) out[k] += j[k] * r[0] + j[3 + k] * r[1] + j[6 + k] * r[2];
    });
  }
  find_velocities(system, share);
  for (std::int32_t row = 0; row < system.rows.unknown_count; ++row) {
    if (share.islands[index_of(island_of_row_[index_of(row)])] == 0) continue;
    const double* const v = force_.data() + 3 * std::int64_t{row};
    velocity[index_of(system.rows.block_of[row])] = {v[0], v[1], v[2]};
  }
  return &solution_.report;
}

}  // namespace tetwarp
