/// @file fclib_contact.cpp
/// Reading contact problems from FCLIB files: FCLIB's M, H, f, w are A, transposed J, b, w here.
#include <algorithm>
#include <tetwarp/error.hpp>
#include <tetwarp/io.hpp>
#include <utility>

#include "io/fclib.hpp"

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
  group.fail("equality constraints are not supported, eliminate them first");
}

Expected rows_of(std::int64_t contacts) {
  return {3 * contacts, "three per contact, and mu has one number per contact"};
}

ContactProblem read_local(const h5::Object& root) {
  check_no_equalities(root, "V");
  check_no_equalities(root, "R");
  const h5::Object vectors = h5::open_group(root, "vectors");
  ContactProblem problem;
  problem.friction = fclib::read_reals(vectors, "mu");
  const Expected rows = rows_of(problem.contact_count());
  problem.free_velocity = fclib::read_reals(vectors, "q", rows);
  problem.delassus = fclib::read_matrix(root, "W", rows, rows, Orientation::plain);
  return problem;
}

ContactProblem read_global(const h5::Object& root) {
  check_no_equalities(root, "G");
  const h5::Object vectors = h5::open_group(root, "vectors");
  ContactProblem problem;
  problem.friction = fclib::read_reals(vectors, "mu");
  problem.load = fclib::read_reals(vectors, "f");
  const Expected rows = rows_of(problem.contact_count());
  const Expected dofs{static_cast<std::int64_t>(problem.load.size()), "as many as vectors/f"};
  problem.velocity_offset = fclib::read_reals(vectors, "w", rows);
  problem.system = fclib::read_matrix(root, "M", dofs, dofs, Orientation::plain);
  problem.jacobian = fclib::read_matrix(root, "H", dofs, rows, Orientation::transposed);
  return problem;
}

AdhesionState read_adhesion(const h5::Object& file, std::int64_t contacts) {
  const h5::Object group = h5::open_group(file, "adhesion");
  AdhesionState adhesion;
  adhesion.time_step = h5::read_real_attribute(group, "time_step", 1).front();
  adhesion.intensity.assign(static_cast<std::size_t>(contacts), 0);
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

std::vector<double> read_start(const h5::Object& file, std::int64_t contacts) {
  std::vector<double> impulse;
  for (const std::string path : {"solution", "guesses/1"}) {
    if (!h5::has_child(file, path.substr(0, path.find('/'))) || !h5::is_group(file, path)) continue;
    const h5::Object group = h5::open_group(file, path);
    if (!h5::has_child(group, "r")) continue;
    impulse = fclib::read_reals(group, "r", rows_of(contacts));
    // Files recorded by programs often hold a /solution of zeros; guesses are then better.
    if (std::any_of(impulse.begin(), impulse.end(), [](double r) { return r != 0; })) break;
  }
  if (impulse.empty() && contacts > 0) {
    file.fail("holds no impulses to start from, neither /solution/r nor /guesses/1/r");
  }
  return impulse;
}
}  // namespace

std::string fclib::path_of(const std::string& field, bool is_local) {
  const std::string root = is_local ? "/fclib_local/" : "/fclib_global/";
  const std::array<std::pair<const char*, std::string>, 10> paths = {{
      {"system", root + "M"},
      {"jacobian", root + "H"},
      {"load", root + "vectors/f"},
      {"velocity_offset", root + "vectors/w"},
      {"delassus", root + "W"},
      {"free_velocity", root + "vectors/q"},
      {"friction", root + "vectors/mu"},
      {"block_start", "/blocks/block_ptr"},
      {"impulse_guess", "/guesses/1/r"},
      {"adhesion.saturation_pressure", "/adhesion/saturation"},
  }};
  for (const auto& [member, path] : paths) {
    if (field.starts_with(member)) return path;
  }
  const std::string adhesion = "adhesion.";
  if (field.starts_with(adhesion)) return "/adhesion/" + field.substr(adhesion.size());
  return root.substr(0, root.size() - 1);
}

ContactProblem read_contact_problem(const std::string& path, ContactStart start) {
  const h5::Silence silence;
  const h5::Object file = h5::open_file(path);
  const h5::Object root = open_problem(file);
  check_dimension(root);
  const bool is_local = root.name == "/fclib_local";
  ContactProblem problem = is_local ? read_local(root) : read_global(root);
  const std::int64_t contacts = problem.contact_count();
  if (is_local && contacts == 0) root.fail("holds no contact, there is nothing to solve");
  if (h5::has_child(file, "adhesion")) problem.adhesion = read_adhesion(file, contacts);
  if (!is_local && h5::has_child(file, "blocks")) problem.block_start = read_blocks(file);
  if (start == ContactStart::stored) problem.impulse_guess = read_start(file, contacts);
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
  return header;
}

}  // namespace tetwarp
