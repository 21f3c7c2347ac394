/// @file contact_files.hpp
/// Small contact problems, and access to their files by HDF5 alone.
#pragma once
#include <hdf5.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

namespace tetwarp::test {

/// A matrix from its rows, zeros left out.
inline SparseMatrix sparse(const std::vector<std::vector<double>>& rows) {
  SparseMatrix matrix;
  matrix.rows = static_cast<std::int64_t>(rows.size());
  matrix.columns = static_cast<std::int64_t>(rows.front().size());
  matrix.row_start = {0};
  for (const std::vector<double>& row : rows) {
    for (std::size_t column = 0; column < row.size(); ++column) {
      if (row[column] == 0) continue;
      matrix.column.push_back(static_cast<std::int32_t>(column));
      matrix.value.push_back(row[column]);
    }
    matrix.row_start.push_back(static_cast<std::int64_t>(matrix.column.size()));
  }
  return matrix;
}

/// The rows of a matrix, zeros included, repeated entries added up.
inline std::vector<std::vector<double>> dense(const SparseMatrix& matrix) {
  std::vector<std::vector<double>> rows(
      static_cast<std::size_t>(matrix.rows),
      std::vector<double>(static_cast<std::size_t>(matrix.columns)));
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (auto e = static_cast<std::size_t>(matrix.row_start[row]);
         e < static_cast<std::size_t>(matrix.row_start[row + 1]); ++e) {
      rows[row][static_cast<std::size_t>(matrix.column[e])] += matrix.value[e];
    }
  }
  return rows;
}

/// A point of 1 kg that lands with 1 m/s and slides with (0.5, 0.25) m/s.
inline ContactProblem sliding_point(double friction = 0.3) {
  ContactProblem problem;
  problem.delassus = sparse({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  problem.free_velocity = {-1, 0.5, 0.25};
  problem.friction = {friction};
  return problem;
}

/// Two coupled contacts whose matrix is not quite symmetric, as in recorded files.
inline ContactProblem local_problem() {
  ContactProblem problem;
  problem.delassus = sparse({{2, 0.25, 0, 0.5, 0, 0},
                             {0.25, 2, 0, 0, 0.5, 0},
                             {0, 0, 2, 0, 0, 0.125},
                             {0.500244140625, 0, 0, 3, 0, 0.25},
                             {0, 0.5, 0, 0, 3, 0},
                             {0, 0, 0.125, 0.25, 0, 3}});
  problem.free_velocity = {-1, 0.25, 0, -0.5, 0.125, 0.0625};
  problem.friction = {0.5, 0.25};
  return problem;
}

/// Two points of 2 and 4 kg, one on the other, the lower one on the floor.
inline ContactProblem global_problem() {
  ContactProblem problem;
  problem.system = sparse({{2, 0, 0, 0, 0, 0},
                           {0, 2, 0, 0, 0, 0},
                           {0, 0, 2, 0, 0, 0},
                           {0, 0, 0, 4, 0, 0},
                           {0, 0, 0, 0, 4, 0},
                           {0, 0, 0, 0, 0, 4}});
  problem.jacobian = sparse({{1, 0, 0, 0, 0, 0},
                             {0, 1, 0, 0, 0, 0},
                             {0, 0, 1, 0, 0, 0},
                             {-1, 0, 0, 1, 0, 0},
                             {0, -1, 0, 0, 1, 0},
                             {0, 0, -1, 0, 0, 1}});
  problem.load = {-0.25, 0, 0.125, -0.5, 0.0625, 0};
  problem.velocity_offset = {0.03125, 0, 0, 0.015625, 0, 0};
  problem.friction = {0.5, 0.25};
  return problem;
}

/// The same with adhesion of every kind, blocks and impulses to start from.
inline ContactProblem adhesive_problem() {
  ContactProblem problem = global_problem();
  AdhesionState& adhesion = problem.adhesion;
  adhesion.time_step = 0.0078125;
  adhesion.area = {0.5, 0.25};
  adhesion.stiffness = {4096, 8192};
  adhesion.tangential_stiffness = {2048, 1024};
  adhesion.intensity = {1, 0.5};
  adhesion.gap = {0.03125 * 0.0078125, 0.0625, 0, 0.015625 * 0.0078125, 0, -0.03125};
  adhesion.energy = {8, 16};
  adhesion.viscosity = {0.5, 1};
  adhesion.bonding_rate = {0.125, 0};
  adhesion.saturation_pressure = {1024, 2048};
  problem.block_start = {0, 3, 6};
  problem.impulse_guess = {0.5, 0, 0, 0.25, 0.125, 0};
  return problem;
}

/// Two points with everything beyond contacts: different friction along the tangents, a joint, a
/// spring, resistance to rolling (of points: against any motion) and impulses to start from.
inline ContactProblem jointed_problem() {
  ContactProblem problem = adhesive_problem();
  problem.second_friction = {0.125, 0.25};
  problem.bilateral.jacobian =
      sparse({{0, 1, 0, 0, -1, 0}, {0, 0, 1, 0, 0, 0}, {0, 0, 0, 0, 0, 1}});
  problem.bilateral.target = {0, 0.5, -0.25};
  problem.bilateral.compliance = {0, 0.5, 0};
  problem.bilateral.group_start = {0, 1, 3};
  problem.bilateral.impulse_guess = {1, 2, 3};
  problem.rolling.contact = {1};
  problem.rolling.jacobian = sparse({{0, 0, 0, 1, 0, 0}, {0, 0, 0, 0, 1, 0}, {0, 0, 0, 0, 0, 1}});
  problem.rolling.rolling = {0.0625};
  problem.rolling.torsion = {0.03125};
  problem.rolling.impulse_guess = {4, 5, 6};
  return problem;
}

/// A body between two walls that have moved closer together than it is thick.
inline ContactProblem squeezed_point() {
  ContactProblem problem;
  problem.system = sparse({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  problem.jacobian = sparse({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 1, 0}, {0, 0, -1}});
  problem.load = {0, 0, 0};
  problem.velocity_offset = {-1, 0, 0, -1, 0, 0};
  problem.friction = {0, 0};
  return problem;
}

/// `count` points of 1 kg in a column, each resting on the one below. Impulses accumulate downward,
/// so that sweeps converge slowly.
inline ContactProblem column_of_points(std::size_t count) {
  ContactProblem problem;
  std::vector<std::vector<double>> mass(3 * count, std::vector<double>(3 * count));
  std::vector<std::vector<double>> jacobian = mass;
  for (std::size_t row = 0; row < 3 * count; ++row) {
    mass[row][row] = 1;
    jacobian[row][row] = 1;
    if (row >= 3) jacobian[row][row - 3] = -1;
  }
  problem.system = sparse(mass);
  problem.jacobian = sparse(jacobian);
  problem.load.assign(3 * count, 0);
  for (std::size_t point = 0; point < count; ++point) problem.load[3 * point] = -1;
  problem.velocity_offset.assign(3 * count, 0);
  problem.friction.assign(count, 0.5);
  return problem;
}

/// Everything a problem holds, to compare problems by.
inline std::vector<std::vector<double>> contents(const ContactProblem& problem) {
  std::vector<std::vector<double>> all = {problem.load,
                                          problem.velocity_offset,
                                          problem.free_velocity,
                                          problem.friction,
                                          {problem.block_start.begin(), problem.block_start.end()},
                                          problem.impulse_guess};
  for (const SparseMatrix* matrix : {&problem.system, &problem.jacobian, &problem.delassus}) {
    all.push_back({static_cast<double>(matrix->rows), static_cast<double>(matrix->columns)});
    all.emplace_back(matrix->row_start.begin(), matrix->row_start.end());
    all.emplace_back(matrix->column.begin(), matrix->column.end());
    all.push_back(matrix->value);
  }
  const BilateralRows& rows = problem.bilateral;
  const RollingFriction& rolling = problem.rolling;
  for (const SparseMatrix* matrix : {&rows.jacobian, &rolling.jacobian}) {
    all.emplace_back(matrix->row_start.begin(), matrix->row_start.end());
    all.emplace_back(matrix->column.begin(), matrix->column.end());
    all.push_back(matrix->value);
  }
  all.emplace_back(rows.group_start.begin(), rows.group_start.end());
  all.emplace_back(rolling.contact.begin(), rolling.contact.end());
  for (const auto& vector :
       {problem.second_friction, rows.target, rows.compliance, rows.impulse_guess, rolling.rolling,
        rolling.torsion, rolling.impulse_guess}) {
    all.push_back(vector);
  }
  const AdhesionState& adhesion = problem.adhesion;
  all.push_back({adhesion.time_step});
  for (const auto& vector : {adhesion.area, adhesion.stiffness, adhesion.tangential_stiffness,
                             adhesion.intensity, adhesion.gap, adhesion.energy, adhesion.viscosity,
                             adhesion.bonding_rate, adhesion.saturation_pressure}) {
    all.push_back(vector);
  }
  return all;
}

/// All numbers of a dataset.
inline std::vector<double> numbers_of(const std::string& path, const std::string& dataset) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t data = H5Dopen2(file, dataset.c_str(), H5P_DEFAULT);
  if (data < 0) throw std::runtime_error("no dataset " + dataset + " in " + path);
  const hid_t space = H5Dget_space(data);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(data);
  H5Fclose(file);
  return values;
}

/// One number of a group's attribute.
inline double attribute_of(const std::string& path,
                           const std::string& group,
                           const std::string& name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t attribute =
      H5Aopen_by_name(file, group.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  if (attribute < 0) throw std::runtime_error("no attribute " + name + " in " + path);
  double value = 0;
  H5Aread(attribute, H5T_NATIVE_DOUBLE, &value);
  H5Aclose(attribute);
  H5Fclose(file);
  return value;
}

/// True when the file holds something of this path.
inline bool holds(const std::string& path, const std::string& name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const bool there = H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0;
  H5Fclose(file);
  return there;
}

}  // namespace tetwarp::test
