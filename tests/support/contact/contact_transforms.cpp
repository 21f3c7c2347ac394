#include "tests/support/contact/contact_transforms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

namespace tetwarp::test {
namespace {
constexpr std::array scalars = {&AdhesionState::area,
                                &AdhesionState::stiffness,
                                &AdhesionState::tangential_stiffness,
                                &AdhesionState::intensity,
                                &AdhesionState::energy,
                                &AdhesionState::viscosity,
                                &AdhesionState::bonding_rate,
                                &AdhesionState::saturation_pressure};

std::vector<std::size_t> shuffled(std::size_t count, std::mt19937_64& random) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

/// Entry i of the result is entry order[i]; an empty vector stays empty.
std::vector<double> reordered(const std::vector<double>& values,
                              const std::vector<std::size_t>& order) {
  std::vector<double> result;
  for (const std::size_t from : order) {
    if (!values.empty()) result.push_back(values[from]);
  }
  return result;
}

/// Row i is row rows[i], its columns renamed by `column_of`.
SparseMatrix reordered(const SparseMatrix& matrix,
                       const std::vector<std::size_t>& rows,
                       const std::vector<std::size_t>& column_of) {
  SparseMatrix result{matrix.rows, matrix.columns, {0}, {}, {}};
  for (const std::size_t row : rows) {
    const auto end = static_cast<std::size_t>(matrix.row_start[row + 1]);
    for (auto e = static_cast<std::size_t>(matrix.row_start[row]); e < end; ++e) {
      const auto column = static_cast<std::size_t>(matrix.column[e]);
      result.column.push_back(static_cast<std::int32_t>(column_of[column]));
      result.value.push_back(matrix.value[e]);
    }
    result.row_start.push_back(static_cast<std::int64_t>(result.column.size()));
  }
  return result;
}

/// Entry (i, j) times rows[i] columns[j].
void scale(SparseMatrix& matrix,
           const std::vector<double>& rows,
           const std::vector<double>& columns) {
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto end = static_cast<std::size_t>(matrix.row_start[row + 1]);
    for (auto e = static_cast<std::size_t>(matrix.row_start[row]); e < end; ++e) {
      matrix.value[e] *= rows[row] * columns[static_cast<std::size_t>(matrix.column[e])];
    }
  }
}

void scale(std::vector<double>& values, const std::vector<double>& factors) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= factors[i];
}

void scale(std::vector<double>& values, double factor) {
  for (double& value : values) value *= factor;
}

/// `pattern` repeated up to `size` entries.
std::vector<double> repeated(const std::vector<double>& pattern, std::size_t size) {
  std::vector<double> result(size);
  for (std::size_t i = 0; i < size; ++i) result[i] = pattern[i % pattern.size()];
  return result;
}
}  // namespace

ContactCase permuted(const ContactCase& original, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const ContactProblem& from = original.problem;
  const std::vector<std::size_t> contacts = shuffled(from.friction.size(), random);
  std::vector<std::size_t> rows;
  for (const std::size_t c : contacts) rows.insert(rows.end(), {3 * c, 3 * c + 1, 3 * c + 2});

  ContactCase result = original;
  ContactProblem& to = result.problem;
  to.block_start = {0};
  std::vector<std::size_t> dofs;
  for (const std::size_t block : shuffled(from.block_start.size() - 1, random)) {
    for (std::int32_t dof = from.block_start[block]; dof < from.block_start[block + 1]; ++dof) {
      dofs.push_back(static_cast<std::size_t>(dof));
    }
    to.block_start.push_back(static_cast<std::int32_t>(dofs.size()));
  }
  std::vector<std::size_t> new_dof(dofs.size());
  for (std::size_t dof = 0; dof < dofs.size(); ++dof) new_dof[dofs[dof]] = dof;

  to.system = reordered(from.system, dofs, new_dof);
  to.jacobian = reordered(from.jacobian, rows, new_dof);
  to.load = reordered(from.load, dofs);
  to.velocity_offset = reordered(from.velocity_offset, rows);
  to.friction = reordered(from.friction, contacts);
  to.impulse_guess = reordered(from.impulse_guess, rows);
  to.adhesion.gap = reordered(from.adhesion.gap, rows);
  for (const auto member : scalars)
    to.adhesion.*member = reordered(from.adhesion.*member, contacts);
  result.impulse = reordered(original.impulse, rows);
  result.body_velocity = reordered(original.body_velocity, dofs);
  return result;
}

ContactCase mirrored(const ContactCase& original) {
  ContactCase result = original;
  ContactProblem& problem = result.problem;
  const std::vector<double> dofs = repeated({-1, 1, 1, 1, -1, -1}, problem.load.size());
  const std::vector<double> rows = repeated({1, 1, -1}, problem.velocity_offset.size());
  scale(problem.system, dofs, dofs);
  scale(problem.jacobian, rows, dofs);
  scale(problem.load, dofs);
  for (std::vector<double>* values :
       {&problem.velocity_offset, &problem.impulse_guess, &problem.adhesion.gap, &result.impulse}) {
    scale(*values, rows);
  }
  scale(result.body_velocity, dofs);
  return result;
}

ContactCase rescaled(const ContactCase& original, double mass, double length, double time) {
  const double speed = length / time;
  const double pressure = mass / (length * time * time);
  ContactCase result = original;
  ContactProblem& problem = result.problem;
  const std::size_t dof_count = problem.load.size();
  const double spin = 1 / time;
  const std::vector<double> velocity = repeated({speed, speed, speed, spin, spin, spin}, dof_count);
  // v' A v and v' b are energies.
  std::vector<double> momentum(dof_count), inverse(dof_count);
  for (std::size_t dof = 0; dof < dof_count; ++dof) {
    momentum[dof] = mass * speed * speed / velocity[dof];
    inverse[dof] = 1 / velocity[dof];
  }
  scale(problem.system, momentum, inverse);
  scale(problem.jacobian, repeated({speed}, problem.velocity_offset.size()), inverse);
  scale(problem.load, momentum);
  scale(problem.velocity_offset, speed);
  scale(problem.impulse_guess, mass * speed);
  scale(result.impulse, mass * speed);
  scale(result.body_velocity, velocity);
  AdhesionState& adhesion = problem.adhesion;
  adhesion.time_step *= time;
  scale(adhesion.area, length * length);
  scale(adhesion.stiffness, pressure / length);
  scale(adhesion.tangential_stiffness, pressure / length);
  scale(adhesion.gap, length);
  scale(adhesion.energy, pressure * length);
  scale(adhesion.viscosity, pressure * length * time);
  scale(adhesion.bonding_rate, 1 / (pressure * time));
  scale(adhesion.saturation_pressure, pressure);
  return result;
}

}  // namespace tetwarp::test
