/// @file condensed_solver.cpp
/// States the problem of the contacts, and takes its solution back.
#include "host/simulate/solve/condensed/condensed_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "host/simulate/solve/problem/contact_laws.hpp"
#include "host/simulate/step/cpu/island_factors.hpp"

namespace tetwarp {
namespace {

ContactOptions on_host(ContactOptions options) {
  options.backend = Backend::cpu;
  return options;
}

}  // namespace

CondensedSolver::CondensedSolver(const ContactOptions& options,
                                 const ContactIslands& islands,
                                 const RestFactors& factors)
    : solver_(on_host(options)), islands_(islands), choice_(islands, factors) {}

void CondensedSolver::take(const Limits& limits,
                           const SystemRows& system,
                           const ContactRows& rows,
                           const ContactProblem& laws,
                           ContactShare& from,
                           ContactShare& to) {
  to.clear(islands_.count());
  coupling_.resize(index_of(islands_.count()));
  if (places_.set(system, islands_)) {
    for (std::int32_t i = 0; i < islands_.count(); ++i) coupling_[index_of(i)].set(places_.of(i));
  }
  choice_.find(limits, system, places_, coupling_, rows, laws, from);
  for (std::int32_t i = 0; i < islands_.count(); ++i) {
    if (from.islands[index_of(i)] == 0 || !choice_.takes(i)) continue;
    from.islands[index_of(i)] = 0;
    to.islands[index_of(i)] = 1;
  }
  std::vector<std::int32_t> left;
  for (const std::int32_t c : from.contacts) {
    (choice_.takes(islands_.of_contact()[index_of(c)]) ? to.contacts : left).push_back(c);
  }
  from.contacts = std::move(left);
}

/// J and W of the contacts. @returns false: the system is singular
bool CondensedSolver::find_matrix(const StepSystem& system,
                                  const ContactRows& rows,
                                  const ContactShare& share) {
  jacobian_.set(rows, share.contacts, places_.row_of_block());
  std::vector<std::vector<std::int32_t>> contacts(coupling_.size());
  for (std::int32_t c = 0; c < jacobian_.count(); ++c) {
    jacobian_.for_blocks(index_of(c), [&](std::size_t b) {
      auto& own = contacts[index_of(places_.of_row(jacobian_.row()[b]))];
      if (own.empty() || own.back() != c) own.push_back(c);
    });
  }
  matrix_.clear(share.contacts.size());
  for (std::size_t i = 0; i < coupling_.size(); ++i) {
    CondensedIsland& own = coupling_[i];
    if (share.islands[i] == 0) {
      own.forget_columns();
      continue;
    }
    RowRangeLu* const made = system.factors != nullptr ? (*system.factors)[i].made() : nullptr;
    if (!own.factor(system, made)) return false;
    own.find_columns(jacobian_, contacts[i]);
    matrix_.add(jacobian_, own);
  }
  return true;
}

/// velocity_ = A^-1 (b + velocity_) on the rows of the islands.
void CondensedSolver::find_velocities(const StepSystem& system, const ContactShare& share) {
  for (std::size_t i = 0; i < coupling_.size(); ++i) {
    if (share.islands[i] == 0) continue;
    const auto [begin, end] = coupling_[i].range();
    for (std::int64_t e = 3 * std::int64_t{begin}; e < 3 * std::int64_t{end}; ++e) {
      velocity_[index_of(e)] += system.load[e];
    }
    coupling_[i].solve(velocity_);
  }
}

/// u = W r + q with the impulses nu_n of the springs at u_n = 0 as part of r.
void CondensedSolver::set_problem(const ContactProblem& laws, const ContactShare& share) {
  gather_laws(share.contacts, laws, problem_);
  laws_.set(problem_);
  problem_.free_velocity.resize(problem_.velocity_offset.size());
  jacobian_.velocities(view_of(std::as_const(velocity_)), problem_.velocity_offset, 1,
                       view_of(problem_.free_velocity));
  matrix_.subtract(laws_.preload, problem_.free_velocity);
  problem_.velocity_offset.clear();
  matrix_.copy(problem_.delassus);
  for (std::size_t c = 0; c < laws_.preload.size(); ++c) {
    problem_.impulse_guess[3 * c] += laws_.preload[c];
  }
}

const ContactReport* CondensedSolver::solve(const StepSystem& system,
                                            const ContactRows& rows,
                                            const ContactProblem& laws,
                                            const ContactShare& share,
                                            std::vector<Point3>& velocity) {
  if (!find_matrix(system, rows, share)) return nullptr;
  velocity_.assign(3 * index_of(system.rows.unknown_count), 0.0);
  find_velocities(system, share);
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (!matrix_.is_valid() || !std::ranges::all_of(velocity_, is_finite)) return nullptr;
  set_problem(laws, share);
  try {
    solution_ = solver_.solve(problem_);
  } catch (const ContactProblemError&) {  // rounding has made W indefinite
    return nullptr;
  }
  for (std::size_t c = 0; c < laws_.preload.size(); ++c) {
    solution_.impulse[3 * c] -= laws_.preload[c];
  }
  std::ranges::fill(velocity_, 0.0);
  jacobian_.add_pushes(solution_.impulse.data(), velocity_.data());
  find_velocities(system, share);
  for (std::size_t i = 0; i < coupling_.size(); ++i) {
    if (share.islands[i] == 0) continue;
    for (std::int32_t row = coupling_[i].range().begin; row < coupling_[i].range().end; ++row) {
      const double* const v = velocity_.data() + 3 * std::int64_t{row};
      velocity[index_of(system.rows.block_of[row])] = {v[0], v[1], v[2]};
    }
  }
  return &solution_.report;
}

}  // namespace tetwarp
