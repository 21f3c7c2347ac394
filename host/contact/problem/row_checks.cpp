/// @file row_checks.cpp
/// check_row_blocks(): friction ellipses, bilateral rows and rolling friction.
#include "host/contact/problem/row_checks.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "host/contact/problem/checks.hpp"
#include "host/contact/problem/matrix.hpp"

namespace tetwarp {
namespace {
constexpr const char* global_form =
    ": set together with delassus; rows beyond contacts take the global form";

std::string number(std::int64_t number) {
  return std::to_string(number);
}

bool is_zero_row(const SparseMatrix& matrix, std::int64_t row) {
  const auto first = matrix.value.begin() + matrix.row_start[index_of(row)];
  const auto last = matrix.value.begin() + matrix.row_start[index_of(row) + 1];
  return std::all_of(first, last, [](double value) { return value == 0; });
}

void check_jacobian(const ContactProblem& problem,
                    const char* field,
                    const SparseMatrix& jacobian,
                    std::int64_t rows,
                    const char* meaning) {
  check_rows(field, jacobian);
  if (jacobian.rows == rows && jacobian.columns == problem.dof_count()) return;
  throw ContactProblemError(field, ": " + number(jacobian.rows) + " rows and " +
                                       number(jacobian.columns) + " columns, expected " + meaning +
                                       " and one per dof, " + number(rows) + " and " +
                                       number(problem.dof_count()));
}

void check_groups(const BilateralRows& rows) {
  const std::vector<std::int32_t>& starts = rows.group_start;
  if (starts.empty()) return;
  const std::string field = "bilateral.group_start";
  if (starts.front() != 0) {
    throw ContactProblemError(field, "[0]: " + number(starts.front()) + ", expected 0");
  }
  for (std::size_t g = 1; g < starts.size(); ++g) {
    const std::int64_t size = std::int64_t{starts[g]} - starts[g - 1];
    if (size >= 1 && size <= 3) continue;
    throw ContactProblemError(field, at(static_cast<std::int64_t>(g)) + number(starts[g]) +
                                         " makes a group of " + number(size) +
                                         " rows; groups have one to three, split larger ones");
  }
  if (starts.back() != rows.row_count()) {
    throw ContactProblemError(field, at(std::ssize(starts) - 1) + number(starts.back()) +
                                         ", expected the number of rows, " +
                                         number(rows.row_count()));
  }
}

void check_bilateral(const ContactProblem& problem) {
  const BilateralRows& rows = problem.bilateral;
  const std::int64_t row_count = rows.row_count();
  if (rows.empty() && rows.target.empty() && rows.compliance.empty() && rows.group_start.empty() &&
      rows.impulse_guess.empty()) {
    return;
  }
  if (problem.is_local()) throw ContactProblemError("bilateral", global_form);
  check_jacobian(problem, "bilateral.jacobian", rows.jacobian, row_count, "any number");
  for (std::int64_t row = 0; row < row_count; ++row) {
    if (!is_zero_row(rows.jacobian, row)) continue;
    throw ContactProblemError("bilateral.jacobian",
                              ": row " + number(row) + " is zero; leave it out");
  }
  if (!rows.target.empty()) {
    check_size("bilateral.target", rows.target.size(), row_count, "one per row, or none");
    check_finite("bilateral.target", rows.target);
  }
  if (!rows.compliance.empty()) {
    check_size("bilateral.compliance", rows.compliance.size(), row_count, "one per row, or none");
    check_not_negative("bilateral.compliance", rows.compliance,
                       "compliances are 0, a hard row, or more");
    for (std::int64_t row = 0; row < row_count; ++row) {
      const double compliance = rows.compliance[index_of(row)];
      if (compliance == 0 || std::isfinite(1 / compliance)) continue;
      throw ContactProblemError(
          "bilateral.compliance",
          at(row) + text_of(compliance) + " has no finite inverse; 0 makes a hard row");
    }
  }
  check_groups(rows);
  if (rows.impulse_guess.empty()) return;
  check_size("bilateral.impulse_guess", rows.impulse_guess.size(), row_count,
             "one per row, or none");
  check_finite("bilateral.impulse_guess", rows.impulse_guess);
}

/// The blocks of dofs that three rows of a matrix act on, sorted.
std::vector<std::int32_t> touched_blocks(const SparseMatrix& jacobian,
                                         std::int64_t first_row,
                                         const std::vector<std::int32_t>& starts) {
  std::vector<std::int32_t> blocks;
  for (std::int64_t e = jacobian.row_start[index_of(first_row)];
       e < jacobian.row_start[index_of(first_row + 3)]; ++e) {
    if (jacobian.value[index_of(e)] == 0) continue;
    const auto next = std::upper_bound(starts.begin(), starts.end(), jacobian.column[index_of(e)]);
    blocks.push_back(static_cast<std::int32_t>(next - starts.begin()));
  }
  std::sort(blocks.begin(), blocks.end());
  return blocks;
}

/// A rolling block must act on a body of its contact: then they are never updated at the same time.
void check_links(const ContactProblem& problem) {
  const RollingFriction& rolling = problem.rolling;
  const std::vector<std::int32_t> starts = blocks_of(problem);
  std::vector<bool> is_taken(problem.friction.size(), false);
  for (std::int64_t k = 0; k < rolling.count(); ++k) {
    const std::int64_t c = rolling.contact[index_of(k)];
    if (c < 0 || c >= problem.contact_count()) {
      throw ContactProblemError("rolling.contact", at(k) + number(c) + ", expected 0 to " +
                                                       number(problem.contact_count() - 1));
    }
    if (is_taken[index_of(c)]) {
      throw ContactProblemError("rolling.contact",
                                at(k) + number(c) + " is named twice; add its coefficients");
    }
    is_taken[index_of(c)] = true;
    const std::vector<std::int32_t> own = touched_blocks(rolling.jacobian, 3 * k, starts);
    const std::vector<std::int32_t> contact = touched_blocks(problem.jacobian, 3 * c, starts);
    const bool shares = std::any_of(own.begin(), own.end(), [&](std::int32_t block) {
      return std::binary_search(contact.begin(), contact.end(), block);
    });
    if (shares) continue;
    throw ContactProblemError("rolling.jacobian",
                              ": rows " + number(3 * k) + " to " + number(3 * k + 2) +
                                  " act on no body of contact " + number(c) +
                                  "; if the dofs of a body are several blocks, give block_start");
  }
}

void check_rolling(const ContactProblem& problem) {
  constexpr std::int64_t most = 1 << 24;  // places of contacts are stored as float32 numbers
  const RollingFriction& rolling = problem.rolling;
  if (rolling.empty() && rolling.jacobian.empty() && rolling.rolling.empty() &&
      rolling.torsion.empty() && rolling.impulse_guess.empty()) {
    return;
  }
  if (problem.is_local()) throw ContactProblemError("rolling", global_form);
  check_jacobian(problem, "rolling.jacobian", rolling.jacobian, 3 * rolling.count(),
                 "3 per entry of rolling.contact");
  check_size("rolling.rolling", rolling.rolling.size(), rolling.count(),
             "one per entry of rolling.contact");
  check_not_negative("rolling.rolling", rolling.rolling, "coefficients are 0 or more, in m");
  check_size("rolling.torsion", rolling.torsion.size(), rolling.count(),
             "one per entry of rolling.contact");
  check_not_negative("rolling.torsion", rolling.torsion, "coefficients are 0 or more, in m");
  check_links(problem);
  if (problem.contact_count() + rolling.count() + problem.bilateral.row_count() > most) {
    throw ContactProblemError("rolling", ": more than 2^24 contacts and rows; split the problem");
  }
  if (rolling.impulse_guess.empty()) return;
  check_size("rolling.impulse_guess", rolling.impulse_guess.size(), 3 * rolling.count(),
             "3 per entry of rolling.contact, or none");
  check_finite("rolling.impulse_guess", rolling.impulse_guess);
}

void check_ellipses(const ContactProblem& problem) {
  const std::vector<double>& second = problem.second_friction;
  if (second.empty()) return;
  check_size("second_friction", second.size(), problem.contact_count(), "one per contact, or none");
  check_not_negative("second_friction", second, "friction coefficients are 0 or more");
  const AdhesionState& adhesion = problem.adhesion;
  const std::vector<double>& stiffness =
      adhesion.tangential_stiffness.empty() ? adhesion.stiffness : adhesion.tangential_stiffness;
  for (std::size_t c = 0; c < second.size(); ++c) {
    const bool has_spring = problem.is_local() && !adhesion.empty() && !adhesion.area.empty() &&
                            !stiffness.empty() && adhesion.intensity[c] > 0 &&
                            adhesion.area[c] > 0 && stiffness[c] > 0;
    if (second[c] == problem.friction[c] || !has_spring) continue;
    throw ContactProblemError("second_friction",
                              at(static_cast<std::int64_t>(c)) +
                                  "differs from friction at a contact with tangential adhesion, "
                                  "which takes the global form");
  }
}
}  // namespace

void check_row_blocks(const ContactProblem& problem) {
  if (!problem.expert.row_blocks.empty()) {
    throw ContactProblemError("expert.row_blocks", ": not empty; it belongs to the solver");
  }
  check_ellipses(problem);
  check_bilateral(problem);
  check_rolling(problem);
}

}  // namespace tetwarp
