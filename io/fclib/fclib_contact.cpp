/// @file fclib_contact.cpp
/// Reading contact problems from FCLIB files: FCLIB's M, H, f, w are A, transposed J, b, w here.
#include <algorithm>
#include <tetwarp/error.hpp>
#include <tetwarp/io.hpp>
#include <utility>

#include "io/fclib/fclib.hpp"
#include "io/fclib/fclib_left_out.hpp"
#include "io/fclib/fclib_matrix.hpp"
#include "io/fclib/fclib_numbers.hpp"
#include "io/fclib/fclib_rows.hpp"
#include "io/h5/h5_attribute.hpp"

namespace tetwarp {
namespace {
using fclib::Expected;
using fclib::Orientation;

/// Opens /fclib_local or /fclib_global, whichever is there.
h5::Object open_problem(const h5::Object& file) {
  const bool is_local = h5::is_group(file, "fclib_local");
  const bool is_global = h5::is_group(file, "fclib_global");
  if (is_local && is_global) {
    file.fail("holds both fclib_local and fclib_global, remove one of them");
  }
  if (is_local) return h5::open_group(file, "fclib_local");
  if (is_global) return h5::open_group(file, "fclib_global");
  for (const char* rolling : {"fclib_local_rolling", "fclib_global_rolling"}) {
    if (h5::has_child(file, rolling)) {
      throw IoError(file.file, std::string("/") + rolling, "rolling friction is not supported");
    }
  }
  file.fail("holds no contact problem, expected /fclib_local or /fclib_global");
}

std::int64_t element_count(const h5::Object& parent, const std::string& name) {
  return fclib::element_count(h5::open_dataset(parent, name));
}

void check_dimension(const h5::Object& root) {
  const std::int64_t dimension = fclib::read_integer(root, "spacedim");
  if (dimension == 3) return;
  throw IoError(root.file, root.name + "/spacedim",
                "is " + std::to_string(dimension) + ", only problems in 3 dimensions can be read" +
                    (dimension == 2 ? "; write the 2D problem with a second tangent" : ""));
}

/// Throws IoError on equality constraints; an empty group of them is accepted.
void check_no_equalities(const h5::Object& root, const std::string& name) {
  if (!h5::has_child(root, name)) return;
  const h5::Object group = h5::open_group(root, name);
  if (fclib::read_integer(group, "n") == 0) return;
  group.fail(
      "equality constraints are not supported in local form, write the problem in global form");
}

Expected rows_of(std::int64_t contacts) {
  return {3 * contacts, "three per contact, and mu has one number per contact"};
}

/// Throws IoError where the other vectors and the matrix agree on another number of contacts than
/// mu.
/// @param vector  name of a vector of three numbers per contact
/// @param edge    path of the number of rows or columns that it belongs to
void check_friction_count(const h5::Object& root,
                          std::int64_t contacts,
                          const std::string& vector,
                          const std::string& matrix,
                          const std::string& edge) {
  const h5::Object vectors = h5::open_group(root, "vectors");
  if (!h5::has_child(vectors, vector) || !h5::has_child(root, matrix)) return;
  const h5::Object group = h5::open_group(root, matrix);
  if (!h5::has_child(group, edge) || element_count(group, edge) != 1) return;
  const std::int64_t rows = element_count(vectors, vector);
  if (rows == 3 * contacts || rows % 3 != 0 || fclib::read_integer(group, edge) != rows) return;
  throw IoError(root.file, vectors.name + "/mu",
                "holds " + std::to_string(contacts) + " numbers, expected " +
                    std::to_string(rows / 3) + ": one per contact, and " + vector + " and " +
                    matrix + " have three rows per contact");
}

/// A symmetric matrix of which one triangle is stored, with both triangles.
SparseMatrix with_both_triangles(SparseMatrix matrix) {
  std::int64_t below = 0, above = 0;
  for (std::int32_t row = 0; row < matrix.rows; ++row) {
    const auto first = static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row)]);
    const auto last = static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row) + 1]);
    for (std::size_t e = first; e < last; ++e) {
      if (matrix.value[e] == 0) continue;
      below += matrix.column[e] < row;
      above += matrix.column[e] > row;
    }
  }
  if ((below == 0) == (above == 0) || matrix.rows != matrix.columns) return matrix;

  SparseMatrix full{matrix.rows, matrix.columns, matrix.row_start, {}, {}};
  const auto for_each_mirrored = [&](const auto& visit) {
    for (std::int32_t row = 0; row < matrix.rows; ++row) {
      const auto last =
          static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row) + 1]);
      for (auto e = static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row)]);
           e < last; ++e) {
        if (matrix.column[e] != row) visit(static_cast<std::size_t>(matrix.column[e]), row, e);
      }
    }
  };
  std::vector<std::int64_t> added(static_cast<std::size_t>(matrix.rows) + 1, 0);
  for_each_mirrored([&](std::size_t row, std::int32_t, std::size_t) { ++added[row + 1]; });
  for (std::size_t row = 1; row < added.size(); ++row) {
    added[row] += added[row - 1];
    full.row_start[row] += added[row];
  }
  full.column.resize(static_cast<std::size_t>(full.row_start.back()));
  full.value.resize(full.column.size());
  std::vector<std::int64_t> next = full.row_start;
  const auto put = [&](std::size_t row, std::int32_t column, std::size_t e) {
    const auto place = static_cast<std::size_t>(next[row]++);
    full.column[place] = column;
    full.value[place] = matrix.value[e];
  };
  for (std::size_t row = 0; row + 1 < matrix.row_start.size(); ++row) {
    for (std::int64_t e = matrix.row_start[row]; e < matrix.row_start[row + 1]; ++e) {
      put(row, matrix.column[static_cast<std::size_t>(e)], static_cast<std::size_t>(e));
    }
  }
  for_each_mirrored(put);
  return full;
}

ContactProblem read_local(const h5::Object& root) {
  check_no_equalities(root, "V");
  check_no_equalities(root, "R");
  const h5::Object vectors = h5::open_group(root, "vectors");
  ContactProblem problem;
  problem.friction = fclib::read_reals(vectors, "mu");
  check_friction_count(root, problem.contact_count(), "q", "W", "m");
  const Expected rows = rows_of(problem.contact_count());
  problem.free_velocity = fclib::read_reals(vectors, "q", rows);
  problem.delassus =
      with_both_triangles(fclib::read_matrix(root, "W", rows, rows, Orientation::plain));
  return problem;
}

ContactProblem read_global(const h5::Object& root) {
  const h5::Object vectors = h5::open_group(root, "vectors");
  ContactProblem problem;
  problem.friction = fclib::read_reals(vectors, "mu");
  problem.load = fclib::read_reals(vectors, "f");
  check_friction_count(root, problem.contact_count(), "w", "H", "n");
  const Expected rows = rows_of(problem.contact_count());
  const Expected dofs{static_cast<std::int64_t>(problem.load.size()), "as many as vectors/f"};
  problem.velocity_offset = fclib::read_reals(vectors, "w", rows);
  problem.system =
      with_both_triangles(fclib::read_matrix(root, "M", dofs, dofs, Orientation::plain));
  problem.jacobian = fclib::read_matrix(root, "H", dofs, rows, Orientation::transposed);
  if (h5::has_child(root, "G") && fclib::read_integer(h5::open_group(root, "G"), "n") != 0) {
    problem.bilateral = fclib::read_bilateral(root, dofs);
  }
  return problem;
}

AdhesionState read_adhesion(const h5::Object& file, std::int64_t contacts) {
  const h5::Object group = h5::open_group(file, "adhesion");
  AdhesionState adhesion;
  adhesion.time_step = h5::read_real_attribute(group, "time_step", 1).front();
  adhesion.intensity.assign(static_cast<std::size_t>(contacts), 0);
  if (contacts > 0 && h5::has_child(group, "stiffness") && !h5::has_child(group, "intensity")) {
    throw IoError(file.file, "/adhesion/intensity",
                  "is missing, but there is a stiffness; add one number per contact, from 0 "
                  "(debonded) to 1 (bonded)");
  }
  for (const fclib::AdhesionVector& vector : fclib::adhesion_vectors) {
    if (!h5::has_child(group, vector.name)) continue;
    const std::string reason =
        vector.per_contact == 1 ? "one per contact" : "normal and two tangents per contact";
    adhesion.*vector.member =
        fclib::read_reals(group, vector.name, {vector.per_contact * contacts, reason});
  }
  return adhesion;
}

std::vector<std::int32_t> read_blocks(const h5::Object& file) {
  std::vector<std::int32_t> block_start;
  const h5::Object group = h5::open_group(file, "blocks");
  for (const std::int64_t start : fclib::read_integers(group, "block_ptr")) {
    if (std::in_range<std::int32_t>(start)) {
      block_start.push_back(static_cast<std::int32_t>(start));
    } else {
      throw IoError(file.file, "/blocks/block_ptr",
                    "holds " + std::to_string(start) + ", expected rows of M");
    }
  }
  return block_start;
}

/// Sets the impulses of a problem to start from.
void read_start(const h5::Object& file, ContactProblem& problem) {
  const std::int64_t contacts = problem.contact_count();
  std::vector<double>& impulse = problem.impulse_guess;
  for (const std::string path : {"solution", "guesses/1"}) {
    if (!h5::has_child(file, path.substr(0, path.find('/'))) || !h5::is_group(file, path)) continue;
    const h5::Object group = h5::open_group(file, path);
    if (!h5::has_child(group, "r")) continue;
    impulse = fclib::read_reals(group, "r", rows_of(contacts));
    fclib::read_row_guesses(group, problem);
    // Files recorded by programs often hold a /solution of zeros; guesses are then better.
    if (std::any_of(impulse.begin(), impulse.end(), [](double r) { return r != 0; })) break;
  }
  if (impulse.empty() && contacts > 0) {
    file.fail("holds no impulses to start from, neither /solution/r nor /guesses/1/r");
  }
}
}  // namespace

ContactProblem read_contact_problem(const std::string& path, ContactStart start) {
  const h5::Silence silence;
  const h5::Object file = h5::open_file(path);
  const h5::Object root = open_problem(file);
  check_dimension(root);
  const bool is_local = root.name == "/fclib_local";
  ContactProblem problem = is_local ? read_local(root) : read_global(root);
  const std::int64_t contacts = problem.contact_count();
  if (h5::has_child(file, "adhesion")) problem.adhesion = read_adhesion(file, contacts);
  if (!is_local && h5::has_child(file, "blocks")) problem.block_start = read_blocks(file);
  fclib::read_extensions(file, problem);
  if (start == ContactStart::stored) read_start(file, problem);
  try {
    check_problem(problem);
  } catch (const ContactProblemError& error) {
    throw IoError(path, fclib::path_of(error.field(), is_local), error.what());
  }
  return problem;
}

ContactFileHeader read_contact_header(const std::string& path) {
  const h5::Silence silence;
  const h5::Object file = h5::open_file(path);
  const h5::Object root = open_problem(file);
  ContactFileHeader header;
  if (h5::is_group(root, "info")) {
    const h5::Object info = h5::open_group(root, "info");
    header.title = fclib::read_text(info, "title");
    header.description = fclib::read_text(info, "description");
  }
  if (h5::is_group(file, "guesses")) {
    const h5::Object guesses = h5::open_group(file, "guesses");
    while (h5::is_group(guesses, std::to_string(header.guesses + 1))) ++header.guesses;
  }
  if (h5::is_group(file, "solution")) {
    const h5::Object solution = h5::open_group(file, "solution");
    header.has_solution = h5::has_child(solution, "r");
    if (h5::has_attribute(solution, "status")) {
      header.status = h5::read_text_attribute(solution, "status");
    }
    if (h5::has_attribute(solution, "residual")) {
      header.residual = h5::read_real_attribute(solution, "residual", 1).front();
    }
  }
  header.not_read = fclib::left_out(file);
  return header;
}

}  // namespace tetwarp
