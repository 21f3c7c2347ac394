/// @file fclib_rows.cpp
/// Friction ellipses, bilateral rows and rolling friction in FCLIB files. FCLIB's own G and b are
/// bilateral rows, G^T v + b = 0; the rest is in groups beside it, which other readers ignore.
#include "io/fclib/fclib_rows.hpp"

#include <algorithm>
#include <tetwarp/error.hpp>
#include <utility>

#include "io/fclib/fclib_matrix.hpp"
#include "io/fclib/fclib_numbers.hpp"
#include "io/h5/h5_write.hpp"

namespace tetwarp::fclib {
namespace {
std::vector<std::int32_t> read_indices(const h5::Object& group, const std::string& name) {
  std::vector<std::int32_t> indices;
  for (const std::int64_t index : read_integers(group, name)) {
    if (!std::in_range<std::int32_t>(index)) {
      throw IoError(group.file, group.name + "/" + name,
                    "holds " + std::to_string(index) + ", expected 32-bit indices");
    }
    indices.push_back(static_cast<std::int32_t>(index));
  }
  return indices;
}

void read_rolling(const h5::Object& file, ContactProblem& problem) {
  const h5::Object group = h5::open_group(file, "rolling");
  RollingFriction& rolling = problem.rolling;
  rolling.contact = read_indices(group, "contact");
  const Expected entries{rolling.count(), "one per number of rolling/contact"};
  const Expected dofs{problem.dof_count(), "as many as vectors/f"};
  const Expected rows{3 * rolling.count(), "three per number of rolling/contact"};
  rolling.jacobian = read_matrix(group, "H", dofs, rows, Orientation::transposed);
  rolling.rolling = read_reals(group, "rolling", entries);
  rolling.torsion = read_reals(group, "torsion", entries);
}

void refuse_local(const h5::Object& file, const ContactProblem& problem, const std::string& name) {
  if (!problem.is_local()) return;
  throw IoError(file.file, "/" + name,
                "is beside /fclib_local, rows beyond those of contacts take the global form");
}
}  // namespace

BilateralRows read_bilateral(const h5::Object& root, const Expected& dofs) {
  const std::int64_t count = read_integer(h5::open_group(root, "G"), "n");
  const Expected rows{count, "one per column of G"};
  BilateralRows result;
  result.jacobian = read_matrix(root, "G", dofs, rows, Orientation::transposed);
  const h5::Object vectors = h5::open_group(root, "vectors");
  result.target = read_reals(vectors, "b", rows);
  for (double& target : result.target) target = target == 0 ? 0 : -target;
  return result;
}

void read_extensions(const h5::Object& file, ContactProblem& problem) {
  if (h5::has_child(file, "friction")) {
    problem.second_friction = read_reals(h5::open_group(file, "friction"), "second",
                                         {problem.contact_count(), "one per contact"});
  }
  if (h5::has_child(file, "bilateral")) {
    refuse_local(file, problem, "bilateral");
    const h5::Object group = h5::open_group(file, "bilateral");
    BilateralRows& rows = problem.bilateral;
    if (h5::has_child(group, "compliance")) {
      rows.compliance = read_reals(group, "compliance", {rows.row_count(), "one per column of G"});
    }
    if (h5::has_child(group, "group_ptr")) rows.group_start = read_indices(group, "group_ptr");
  }
  if (!h5::has_child(file, "rolling")) return;
  refuse_local(file, problem, "rolling");
  read_rolling(file, problem);
}

void read_row_guesses(const h5::Object& group, ContactProblem& problem) {
  if (!problem.bilateral.empty() && h5::has_child(group, "l")) {
    problem.bilateral.impulse_guess =
        read_reals(group, "l", {problem.bilateral.row_count(), "one per column of G"});
  }
  if (!problem.rolling.empty() && h5::has_child(group, "m")) {
    problem.rolling.impulse_guess = read_reals(
        group, "m", {3 * problem.rolling.count(), "three per number of rolling/contact"});
  }
}

void write_bilateral(const h5::Object& root, const h5::Object& vectors, const BilateralRows& rows) {
  if (rows.empty()) return;
  write_matrix(root, "G", rows.jacobian, Orientation::transposed);
  std::vector<double> b(static_cast<std::size_t>(rows.row_count()), 0.0);
  for (std::size_t row = 0; row < rows.target.size(); ++row) {
    b[row] = rows.target[row] == 0 ? 0 : -rows.target[row];
  }
  write_reals(vectors, "b", b);
}

void write_extensions(const h5::Object& file, const ContactProblem& problem) {
  if (!problem.second_friction.empty()) {
    write_reals(h5::create_group(file, "friction"), "second", problem.second_friction);
  }
  const BilateralRows& rows = problem.bilateral;
  if (!rows.compliance.empty() || !rows.group_start.empty()) {
    const h5::Object group = h5::create_group(file, "bilateral");
    if (!rows.compliance.empty()) write_reals(group, "compliance", rows.compliance);
    if (!rows.group_start.empty()) {
      write_integers(group, "group_ptr", {rows.group_start.begin(), rows.group_start.end()});
    }
  }
  const RollingFriction& rolling = problem.rolling;
  if (rolling.empty()) return;
  const h5::Object group = h5::create_group(file, "rolling");
  write_integers(group, "contact", {rolling.contact.begin(), rolling.contact.end()});
  write_matrix(group, "H", rolling.jacobian, Orientation::transposed);
  write_reals(group, "rolling", rolling.rolling);
  write_reals(group, "torsion", rolling.torsion);
}

}  // namespace tetwarp::fclib
