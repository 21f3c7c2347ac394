/// @file problem.cpp
/// check_problem(): the checks that every solve makes before it computes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <tetwarp/contact_problem.hpp>
#include <utility>
#include <vector>

#include "host/contact/problem/checks.hpp"
#include "host/contact/problem/matrix.hpp"
#include "host/contact/problem/row_checks.hpp"
#include "kernels/contact/check_limits.hpp"

namespace tetwarp {
namespace {
constexpr std::int64_t max_contacts = std::numeric_limits<std::int32_t>::max() / 3;

std::string count(std::int64_t number) {
  return std::to_string(number);
}

void check_form(const ContactProblem& problem) {
  const bool local = !problem.delassus.empty() || !problem.free_velocity.empty();
  const bool global = !problem.system.empty() || !problem.jacobian.empty() ||
                      !problem.load.empty() || !problem.velocity_offset.empty();
  if (local && global) {
    throw ContactProblemError(
        "delassus",
        ": set together with system, jacobian, load or velocity_offset; clear the "
        "members of the local or of the global form");
  }
  // A matrix of no rows that has its row start is the local form without contacts.
  if (!local && !global && problem.delassus.row_start.empty()) {
    throw ContactProblemError("system",
                              ": empty, and so is delassus; fill system, jacobian, load and "
                              "velocity_offset, or delassus and free_velocity");
  }
}

void check_square(const std::string& field, const SparseMatrix& matrix) {
  if (matrix.rows == matrix.columns) return;
  throw ContactProblemError(field, ": " + count(matrix.rows) + " rows and " +
                                       count(matrix.columns) + " columns; it must be square");
}

void check_blocks(const ContactProblem& problem) {
  const std::vector<std::int32_t>& starts = problem.block_start;
  if (starts.empty()) return;
  if (starts.front() != 0) {
    throw ContactProblemError("block_start", "[0]: " + count(starts.front()) + ", expected 0");
  }
  for (std::size_t b = 1; b < starts.size(); ++b) {
    if (starts[b - 1] < starts[b]) continue;
    throw ContactProblemError("block_start", at(static_cast<std::int64_t>(b)) + count(starts[b]) +
                                                 " is not greater than the previous entry; every "
                                                 "block has at least one dof");
  }
  if (starts.back() != problem.dof_count()) {
    throw ContactProblemError(
        "block_start", at(static_cast<std::int64_t>(starts.size()) - 1) + count(starts.back()) +
                           ", expected the number of dofs, " + count(problem.dof_count()));
  }
}

/// Whether friction or a spring acts on the tangential rows of a contact.
bool resists_sliding(const ContactProblem& problem, std::size_t c) {
  const AdhesionState& adhesion = problem.adhesion;
  const std::vector<double>& stiffness =
      adhesion.tangential_stiffness.empty() ? adhesion.stiffness : adhesion.tangential_stiffness;
  const bool has_second = c < problem.second_friction.size() && problem.second_friction[c] > 0;
  return problem.friction[c] > 0 || has_second ||
         (!adhesion.empty() && adhesion.intensity[c] > 0 && !stiffness.empty() && stiffness[c] > 0);
}

/// Impulses must change the velocity of every normal row and, where something resists sliding, of
/// one tangential row, and by more than what rounding leaves of a row that should be zero.
/// @param diagonal  [3 contacts]: the diagonal of the Delassus matrix, or the largest entry of each
///                  row of J
/// @param rounding  share of the largest diagonal of all at which a row is rounding
void check_diagonal(const ContactProblem& problem,
                    const std::string& field,
                    std::span<const double> diagonal,
                    double rounding) {
  static constexpr const char* remedy =
      "; impulses do not change its velocity, leave out contacts between fixed bodies";
  double largest = 0;
  for (const double entry : diagonal) largest = std::max(largest, entry);
  const double smallest = rounding * largest;
  for (std::size_t c = 0; c < problem.friction.size(); ++c) {
    const auto row = 3 * static_cast<std::int64_t>(c);
    const double push = std::max(diagonal[3 * c + 1], diagonal[3 * c + 2]);
    const bool is_rounding =
        diagonal[3 * c] < smallest || (resists_sliding(problem, c) && push > 0 && push < smallest);
    if (diagonal[3 * c] > 0 && push >= 0 && is_rounding) {
      throw ContactProblemError(
          field, ": rows " + count(row) + " to " + count(row + 2) + " of contact " +
                     count(row / 3) + " have sizes " + text_of(diagonal[3 * c]) + ", " +
                     text_of(diagonal[3 * c + 1]) + " and " + text_of(diagonal[3 * c + 2]) +
                     ", which is rounding beside " + text_of(largest) +
                     ", the largest; leave the contact out, or set its tangent rows and its "
                     "friction to 0");
    }
    if (!(diagonal[3 * c] > 0)) {
      throw ContactProblemError(field, ": normal row " + count(row) + " of contact " +
                                           count(row / 3) + " has diagonal " +
                                           text_of(diagonal[3 * c]) + remedy);
    }
    const auto [low, high] = std::minmax(diagonal[3 * c + 1], diagonal[3 * c + 2]);
    if (low < 0 || (resists_sliding(problem, c) && !(high > 0))) {
      throw ContactProblemError(field, ": tangent rows " + count(row + 1) + " and " +
                                           count(row + 2) + " of contact " + count(row / 3) +
                                           " have diagonals " + text_of(diagonal[3 * c + 1]) +
                                           " and " + text_of(diagonal[3 * c + 2]) + remedy);
    }
  }
}

/// The sum of the stored numbers of an entry.
double entry_of(const SparseMatrix& matrix, std::size_t row, std::size_t column) {
  double sum = 0;
  for (std::int64_t e = matrix.row_start[row]; e < matrix.row_start[row + 1]; ++e) {
    const auto entry = static_cast<std::size_t>(e);
    if (static_cast<std::size_t>(matrix.column[entry]) == column) sum += matrix.value[entry];
  }
  return sum;
}

/// Refuses entries that no positive semidefinite matrix has: |W_ij + W_ji| / 2 beyond the geometric
/// mean of W_ii and W_jj, by more than semidefinite_slack.
void check_semidefinite(const SparseMatrix& delassus, std::span<const double> diagonal) {
  const double largest = diagonal.empty() ? 0 : *std::max_element(diagonal.begin(), diagonal.end());
  for (std::size_t row = 0; row < diagonal.size(); ++row) {
    for (std::int64_t e = delassus.row_start[row]; e < delassus.row_start[row + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      const auto column = static_cast<std::size_t>(delassus.column[entry]);
      const double bound =
          semidefinite_slack.host * std::sqrt(diagonal[row]) * std::sqrt(diagonal[column]) +
          semidefinite_rounding.host * largest;
      if (std::abs(delassus.value[entry]) <= bound) continue;
      const double mean = (entry_of(delassus, row, column) + entry_of(delassus, column, row)) / 2;
      if (std::abs(mean) <= bound) continue;
      throw ContactProblemError(
          "delassus", "(" + count(static_cast<std::int64_t>(row)) + ", " +
                          count(static_cast<std::int64_t>(column)) + "): " + text_of(mean) +
                          " is more than the diagonals " + text_of(diagonal[row]) + " and " +
                          text_of(diagonal[column]) +
                          " allow; J A^-1 J^T is positive semidefinite, correct its assembly");
    }
  }
}

void check_local(const ContactProblem& problem) {
  const std::int64_t rows = 3 * problem.contact_count();
  check_rows("delassus", problem.delassus);
  check_square("delassus", problem.delassus);
  if (problem.delassus.rows != rows) {
    throw ContactProblemError("delassus", ": " + count(problem.delassus.rows) +
                                              " rows, expected 3 per contact, " + count(rows));
  }
  check_size("free_velocity", problem.free_velocity.size(), rows, "3 per contact");
  check_finite("free_velocity", problem.free_velocity);
  if (!problem.block_start.empty()) {
    throw ContactProblemError("block_start",
                              ": set together with delassus, a form without dofs; clear it");
  }
  std::vector<double> diagonal(static_cast<std::size_t>(rows), 0.0);
  for (std::size_t row = 0; row < diagonal.size(); ++row) {
    for (std::int64_t e = problem.delassus.row_start[row]; e < problem.delassus.row_start[row + 1];
         ++e) {
      const auto entry = static_cast<std::size_t>(e);
      if (static_cast<std::size_t>(problem.delassus.column[entry]) == row) {
        diagonal[row] += problem.delassus.value[entry];
      }
    }
  }
  check_diagonal(problem, "delassus", diagonal, delassus_rounding.host);
  check_semidefinite(problem.delassus, diagonal);
}

void check_global(const ContactProblem& problem) {
  const std::int64_t dofs = problem.dof_count();
  const std::int64_t rows = 3 * problem.contact_count();
  check_rows("system", problem.system);
  check_square("system", problem.system);
  check_rows("jacobian", problem.jacobian);
  if (problem.jacobian.rows != rows || (rows > 0 && problem.jacobian.columns != dofs)) {
    throw ContactProblemError("jacobian", ": " + count(problem.jacobian.rows) + " rows and " +
                                              count(problem.jacobian.columns) +
                                              " columns, expected 3 per contact and one per dof, " +
                                              count(rows) + " and " + count(dofs));
  }
  check_size("load", problem.load.size(), dofs, "one per dof");
  check_finite("load", problem.load);
  check_size("velocity_offset", problem.velocity_offset.size(), rows, "3 per contact");
  check_finite("velocity_offset", problem.velocity_offset);
  check_blocks(problem);
  if (has_sorted_rows(problem.system)) {
    check_symmetric(problem.system);
    check_positive_blocks(problem.system, blocks_of(problem));
  } else {
    const SparseMatrix sorted = make_sorted(problem.system);
    check_symmetric(sorted);
    check_positive_blocks(sorted, blocks_of(problem));
  }
  std::vector<double> sizes(static_cast<std::size_t>(rows), 0.0);
  for (std::size_t row = 0; row < sizes.size(); ++row) {
    for (std::int64_t e = problem.jacobian.row_start[row]; e < problem.jacobian.row_start[row + 1];
         ++e) {
      sizes[row] =
          std::max(sizes[row], std::abs(problem.jacobian.value[static_cast<std::size_t>(e)]));
    }
  }
  check_diagonal(problem, "jacobian", sizes, jacobian_rounding.host);
}

void check_adhesion(const ContactProblem& problem) {
  const AdhesionState& adhesion = problem.adhesion;
  const std::int64_t contacts = problem.contact_count();
  const std::pair<const char*, const std::vector<double>*> fields[] = {
      {"adhesion.area", &adhesion.area},
      {"adhesion.stiffness", &adhesion.stiffness},
      {"adhesion.tangential_stiffness", &adhesion.tangential_stiffness},
      {"adhesion.intensity", &adhesion.intensity},
      {"adhesion.energy", &adhesion.energy},
      {"adhesion.viscosity", &adhesion.viscosity},
      {"adhesion.bonding_rate", &adhesion.bonding_rate},
      {"adhesion.saturation_pressure", &adhesion.saturation_pressure}};
  for (const auto& [name, values] : fields) {
    if (values->empty()) continue;
    check_size(name, values->size(), contacts, "one per contact");
    check_not_negative(name, *values, "it is 0 or more; leave the vector empty for no such effect");
  }
  bool any_adheres = false;
  for (std::size_t c = 0; c < adhesion.intensity.size(); ++c) {
    any_adheres = any_adheres || adhesion.intensity[c] > 0;
    if (adhesion.intensity[c] <= 1) continue;
    throw ContactProblemError("adhesion.intensity",
                              at(static_cast<std::int64_t>(c)) + text_of(adhesion.intensity[c]) +
                                  " is above 1; 0 is debonded, 1 fully bonded");
  }
  if (!(adhesion.time_step >= 0) || std::isinf(adhesion.time_step) ||
      (any_adheres && adhesion.time_step == 0)) {
    throw ContactProblemError("adhesion.time_step", ": " + text_of(adhesion.time_step) +
                                                        "; a step of adhering contacts takes a "
                                                        "finite time above 0 s");
  }
  if (!adhesion.gap.empty()) {
    check_size("adhesion.gap", adhesion.gap.size(), 3 * contacts, "3 per contact");
    check_finite("adhesion.gap", adhesion.gap);
  }
}
}  // namespace

void check_problem(const ContactProblem& problem) {
  check_form(problem);
  if (problem.contact_count() > max_contacts) {
    throw ContactProblemError("friction", ": " + count(problem.contact_count()) +
                                              " contacts, at most (2^31 - 1) / 3 fit");
  }
  check_not_negative("friction", problem.friction, "friction coefficients are 0 or more");
  check_adhesion(problem);
  if (problem.is_local() || !problem.free_velocity.empty()) {
    check_local(problem);
  } else {
    check_global(problem);
  }
  if (!problem.impulse_guess.empty()) {
    check_size("impulse_guess", problem.impulse_guess.size(), 3 * problem.contact_count(),
               "3 per contact, or none");
    check_finite("impulse_guess", problem.impulse_guess);
  }
  check_row_blocks(problem);
}

}  // namespace tetwarp
