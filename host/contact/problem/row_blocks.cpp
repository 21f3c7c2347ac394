/// @file row_blocks.cpp
/// Makes the blocks of a problem, and turns their solution back into that of the problem.
#include "host/contact/problem/row_blocks.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "host/contact/problem/checks.hpp"
#include "kernels/contact/contact_law.hpp"

namespace tetwarp {
namespace {
constexpr auto contact_kind = static_cast<std::uint8_t>(ContactKind::coulomb);
constexpr auto bilateral_kind = static_cast<std::uint8_t>(ContactKind::bilateral);
constexpr auto rolling_kind = static_cast<std::uint8_t>(ContactKind::rolling);

/// Sets an array of one value per contact to one per block, zeros for the others, unless empty.
void lengthen(std::vector<double>& values, std::size_t size) {
  if (!values.empty()) values.resize(size, 0.0);
}

/// An entry of a vector whose emptiness means zeros.
double entry_of(const std::vector<double>& values, std::size_t i) {
  return values.empty() ? 0.0 : values[i];
}

/// kappa_t of a contact [kg].
double tangent_spring(const AdhesionState& adhesion, std::size_t c) {
  if (adhesion.empty()) return 0;
  const double stiffness = adhesion.tangential_stiffness.empty() ? entry_of(adhesion.stiffness, c)
                                                                 : adhesion.tangential_stiffness[c];
  const double beta = adhesion.intensity[c];
  return adhesion.time_step * adhesion.time_step * entry_of(adhesion.area, c) * stiffness * beta *
         beta;
}

/// First row of each group, then the number of rows.
std::vector<std::int32_t> group_starts(const BilateralRows& rows) {
  if (!rows.group_start.empty()) return rows.group_start;
  std::vector<std::int32_t> starts;
  for (std::int64_t row = 0; row <= rows.row_count(); ++row) {
    starts.push_back(static_cast<std::int32_t>(row));
  }
  return starts;
}

void check_length(const char* name, std::size_t size, std::size_t expected) {
  if (size == expected) return;
  throw std::invalid_argument(std::string(name) + ": " + std::to_string(size) +
                              " entries, expected " + std::to_string(expected));
}
}  // namespace

bool is_contact_block(const ContactProblem& problem, std::size_t c) {
  return problem.expert.row_blocks.empty() ||
         is_contact(static_cast<ContactKind>(problem.expert.row_blocks.kind[c]));
}

bool has_rolling(const ContactProblem& problem) {
  const std::vector<std::uint8_t>& kinds = problem.expert.row_blocks.kind;
  return std::find(kinds.begin(), kinds.end(), rolling_kind) != kinds.end();
}

bool needs_blocks(const ContactProblem& problem) {
  return !problem.bilateral.empty() || !problem.rolling.empty() ||
         (!problem.second_friction.empty() && problem.second_friction != problem.friction);
}

BlockProblem::BlockProblem(const ContactProblem& given, const ContactOptions& options)
    : given_(given), blocks_(given) {
  if (!given.rolling.empty() && options.method == ContactMethod::newton) {
    throw ContactProblemError("rolling",
                              ": method newton has no rolling friction; choose automatic");
  }
  blocks_.second_friction.clear();
  blocks_.bilateral = {};
  blocks_.rolling = {};
  const std::size_t contacts = given.friction.size();
  blocks_.expert.row_blocks = {std::vector<std::uint8_t>(contacts, contact_kind),
                               std::vector<std::int32_t>(contacts, -1),
                               std::vector<double>(contacts, 0)};
  if (given.jacobian.empty() && !given.is_local()) {
    blocks_.jacobian = {0, given.dof_count(), {0}, {}, {}};
  }
  if (!given.second_friction.empty()) scale_tangents();
  if (!sprung_.empty() && options.rule == AdhesionRule::restrictive) {
    throw ContactProblemError("second_friction",
                              at(sprung_.front()) +
                                  "differs from friction at a contact with tangential adhesion, "
                                  "which rule restrictive does not define; choose rule parallel");
  }
  const bool has_guess = !given.impulse_guess.empty() || !given.bilateral.impulse_guess.empty() ||
                         !given.rolling.impulse_guess.empty();
  add_groups();
  add_rolling();
  add_springs();
  const std::size_t blocks = blocks_.friction.size();
  AdhesionState& adhesion = blocks_.adhesion;
  for (std::vector<double>* values :
       {&adhesion.area, &adhesion.stiffness, &adhesion.tangential_stiffness, &adhesion.intensity,
        &adhesion.energy, &adhesion.viscosity, &adhesion.bonding_rate,
        &adhesion.saturation_pressure}) {
    lengthen(*values, blocks);
  }
  lengthen(adhesion.gap, 3 * blocks);
  if (!given.is_local()) {
    blocks_.system.rows = blocks_.system.columns = blocks_.jacobian.columns =
        static_cast<std::int64_t>(blocks_.load.size());
  }
  if (!has_guess) return;
  ContactSolution guess;
  guess.impulse = given.impulse_guess;
  guess.impulse.resize(3 * contacts, 0.0);
  guess.bilateral_impulse = given.bilateral.impulse_guess;
  guess.bilateral_impulse.resize(index_of(given.bilateral.row_count()), 0.0);
  guess.rolling_impulse = given.rolling.impulse_guess;
  guess.rolling_impulse.resize(3 * given.rolling.contact.size(), 0.0);
  blocks_.impulse_guess = impulse_of(guess);
}

/// Multiplies the tangential rows of contacts with a friction ellipse by e.
void BlockProblem::scale_tangents() {
  const std::size_t contacts = given_.friction.size();
  scale_.assign(2 * contacts, 1.0);
  for (std::size_t c = 0; c < contacts; ++c) {
    const double first = given_.friction[c], second = given_.second_friction[c];
    if (first == second) continue;
    const double larger = std::max(first, second);
    blocks_.friction[c] = larger;
    scale_[2 * c] = first / larger;
    scale_[2 * c + 1] = second / larger;
    if (!(tangent_spring(given_.adhesion, c) > 0)) continue;
    sprung_.push_back(static_cast<std::int32_t>(c));
    AdhesionState& adhesion = blocks_.adhesion;
    if (adhesion.tangential_stiffness.empty()) {
      adhesion.tangential_stiffness = adhesion.stiffness;
    }
    adhesion.tangential_stiffness[c] = 0;
  }
  const auto scale_of = [&](std::size_t row) {
    return row % 3 == 0 ? 1.0 : scale_[2 * (row / 3) + row % 3 - 1];
  };
  const bool is_local = given_.is_local();
  SparseMatrix& matrix = is_local ? blocks_.delassus : blocks_.jacobian;
  std::vector<double>& offset = is_local ? blocks_.free_velocity : blocks_.velocity_offset;
  for (std::size_t row = 0; row < 3 * contacts; ++row) {
    const double scale = scale_of(row);
    offset[row] *= scale;
    for (std::int64_t e = matrix.row_start[row]; e < matrix.row_start[row + 1]; ++e) {
      double& value = matrix.value[index_of(e)];
      value *= scale;
      if (is_local) value *= scale_of(index_of(matrix.column[index_of(e)]));
    }
  }
}

/// Adds one row to J: a row of `rows`, and a dof for its compliance.
void BlockProblem::add_row(const SparseMatrix& rows,
                           std::int64_t row,
                           double offset,
                           double compliance) {
  SparseMatrix& jacobian = blocks_.jacobian;
  const auto first = rows.row_start[index_of(row)], last = rows.row_start[index_of(row) + 1];
  jacobian.column.insert(jacobian.column.end(), rows.column.begin() + first,
                         rows.column.begin() + last);
  jacobian.value.insert(jacobian.value.end(), rows.value.begin() + first,
                        rows.value.begin() + last);
  if (compliance > 0) {
    const auto dof = static_cast<std::int32_t>(blocks_.load.size());
    compliance_.push_back(compliance);
    row_of_dof_.push_back(jacobian.rows);
    jacobian.column.push_back(dof);
    jacobian.value.push_back(1);
    blocks_.load.push_back(0);
    blocks_.system.column.push_back(dof);
    blocks_.system.value.push_back(1 / compliance);
    blocks_.system.row_start.push_back(static_cast<std::int64_t>(blocks_.system.column.size()));
    if (!blocks_.block_start.empty()) blocks_.block_start.push_back(dof + 1);
  }
  blocks_.velocity_offset.push_back(offset);
  jacobian.row_start.push_back(static_cast<std::int64_t>(jacobian.column.size()));
  ++jacobian.rows;
}

/// Fills the block of the last rows up to three rows.
void BlockProblem::end_block(std::uint8_t kind,
                             double friction,
                             std::int32_t contact,
                             double torsion) {
  while (blocks_.jacobian.rows % 3 != 0) {
    blocks_.jacobian.row_start.push_back(blocks_.jacobian.row_start.back());
    blocks_.velocity_offset.push_back(0);
    ++blocks_.jacobian.rows;
  }
  blocks_.friction.push_back(friction);
  blocks_.expert.row_blocks.kind.push_back(kind);
  blocks_.expert.row_blocks.contact.push_back(contact);
  blocks_.expert.row_blocks.torsion.push_back(torsion);
}

void BlockProblem::add_groups() {
  const BilateralRows& rows = given_.bilateral;
  if (rows.empty()) return;
  const std::vector<std::int32_t> starts = group_starts(rows);
  for (std::size_t g = 0; g + 1 < starts.size(); ++g) {
    for (std::int32_t row = starts[g]; row < starts[g + 1]; ++row) {
      add_row(rows.jacobian, row, -entry_of(rows.target, index_of(row)),
              entry_of(rows.compliance, index_of(row)));
    }
    end_block(bilateral_kind, 0, -1, 0);
  }
}

void BlockProblem::add_rolling() {
  const RollingFriction& rolling = given_.rolling;
  for (std::size_t k = 0; k < rolling.contact.size(); ++k) {
    for (std::int64_t a = 0; a < 3; ++a) {
      add_row(rolling.jacobian, 3 * static_cast<std::int64_t>(k) + a, 0, 0);
    }
    end_block(rolling_kind, rolling.rolling[k], rolling.contact[k], rolling.torsion[k]);
  }
}

void BlockProblem::add_springs() {
  const AdhesionState& adhesion = given_.adhesion;
  for (const std::int32_t c : sprung_) {
    const double compliance = 1 / tangent_spring(adhesion, index_of(c));
    for (std::int64_t row = 3 * std::int64_t{c} + 1; row < 3 * std::int64_t{c} + 3; ++row) {
      const double stretch = entry_of(adhesion.gap, index_of(row)) / adhesion.time_step;
      add_row(given_.jacobian, row, given_.velocity_offset[index_of(row)] + stretch, compliance);
    }
    end_block(bilateral_kind, 0, -1, 0);
  }
}

void BlockProblem::set_solution(std::span<const double> impulse,
                                std::span<const double> body_velocity,
                                ContactSolution& solution) const {
  const std::size_t contacts = given_.friction.size();
  std::size_t block = 3 * contacts;
  solution.impulse.assign(impulse.begin(), impulse.begin() + static_cast<std::ptrdiff_t>(block));
  for (std::size_t i = 0; i < scale_.size(); ++i)
    solution.impulse[i / 2 * 3 + i % 2 + 1] *= scale_[i];
  solution.bilateral_impulse.clear();
  if (!given_.bilateral.empty()) {
    const std::vector<std::int32_t> starts = group_starts(given_.bilateral);
    for (std::size_t g = 0; g + 1 < starts.size(); ++g, block += 3) {
      for (std::int32_t row = starts[g]; row < starts[g + 1]; ++row) {
        solution.bilateral_impulse.push_back(impulse[block + index_of(row - starts[g])]);
      }
    }
  }
  const auto rolling = impulse.begin() + static_cast<std::ptrdiff_t>(block);
  solution.rolling_impulse.assign(rolling, rolling + 3 * std::ssize(given_.rolling.contact));
  block += 3 * given_.rolling.contact.size();
  for (const std::int32_t c : sprung_) {
    for (std::size_t a = 0; a < 2; ++a)
      solution.impulse[3 * index_of(c) + 1 + a] += impulse[block + a];
    block += 3;
  }
  solution.body_velocity.assign(body_velocity.begin(), body_velocity.begin() + given_.dof_count());
}

std::vector<double> BlockProblem::impulse_of(const ContactSolution& solution) const {
  const std::size_t contacts = given_.friction.size();
  check_length("impulse", solution.impulse.size(), 3 * contacts);
  check_length("bilateral_impulse", solution.bilateral_impulse.size(),
               index_of(given_.bilateral.row_count()));
  check_length("rolling_impulse", solution.rolling_impulse.size(),
               3 * given_.rolling.contact.size());
  std::vector<double> impulse = solution.impulse;
  if (!given_.bilateral.empty()) {
    const std::vector<std::int32_t> starts = group_starts(given_.bilateral);
    for (std::size_t g = 0; g + 1 < starts.size(); ++g) {
      for (std::int32_t row = starts[g]; row < starts[g] + 3; ++row) {
        impulse.push_back(row < starts[g + 1] ? solution.bilateral_impulse[index_of(row)] : 0.0);
      }
    }
  }
  impulse.insert(impulse.end(), solution.rolling_impulse.begin(), solution.rolling_impulse.end());
  for (const std::int32_t c : sprung_) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t row = 3 * index_of(c) + 1 + a;
      double spring = 0;
      if (a < 2 && !solution.velocity.empty()) {
        const double stretch = entry_of(given_.adhesion.gap, row) / given_.adhesion.time_step;
        spring = -tangent_spring(given_.adhesion, index_of(c)) * (solution.velocity[row] + stretch);
        impulse[row] -= spring;
      }
      impulse.push_back(spring);
    }
  }
  for (std::size_t i = 0; i < scale_.size(); ++i) {
    // Without friction along a tangent its row is empty, and any impulse there an error.
    double& r = impulse[i / 2 * 3 + i % 2 + 1];
    r = scale_[i] > 0 ? r / scale_[i] : 0.0;
  }
  return impulse;
}

std::vector<double> BlockProblem::body_velocity_of(const ContactSolution& solution,
                                                   std::span<const double> impulse) const {
  check_length("body_velocity", solution.body_velocity.size(), index_of(given_.dof_count()));
  std::vector<double> v = solution.body_velocity;
  for (std::size_t i = 0; i < compliance_.size(); ++i) {
    v.push_back(compliance_[i] * impulse[index_of(row_of_dof_[i])]);
  }
  return v;
}

}  // namespace tetwarp
