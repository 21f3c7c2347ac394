/// @file fclib_write.cpp
/// Writes problems and solutions as FCLIB files that FCLIB's own readers accept.
#include <string>
#include <tetwarp/error.hpp>
#include <tetwarp/io.hpp>

#include "io/fclib/fclib.hpp"
#include "io/fclib/fclib_matrix.hpp"
#include "io/fclib/fclib_numbers.hpp"
#include "io/fclib/fclib_rows.hpp"
#include "io/h5/h5_output.hpp"
#include "io/h5/h5_write.hpp"

namespace tetwarp {
namespace {
using fclib::Orientation;
using fclib::write_integers;
using fclib::write_reals;
using fclib::write_text;

void write_problem(const h5::Object& root, const ContactProblem& problem) {
  write_integers(root, "spacedim", {3});
  const h5::Object vectors = h5::create_group(root, "vectors");
  write_reals(vectors, "mu", problem.friction);
  if (problem.is_local()) {
    fclib::write_matrix(root, "W", problem.delassus, Orientation::plain);
    write_reals(vectors, "q", problem.free_velocity);
  } else {
    fclib::write_matrix(root, "M", problem.system, Orientation::plain);
    // A problem without contacts may lack a Jacobian; FCLIB needs its sizes all the same.
    const bool has_contacts = problem.contact_count() > 0;
    const SparseMatrix empty_jacobian{0, problem.dof_count(), {0}, {}, {}};
    fclib::write_matrix(root, "H", has_contacts ? problem.jacobian : empty_jacobian,
                        Orientation::transposed);
    write_reals(vectors, "f", problem.load);
    write_reals(vectors, "w", problem.velocity_offset);
    fclib::write_bilateral(root, vectors, problem.bilateral);
  }
}

void write_info(const h5::Object& root, const std::string& title, const std::string& description) {
  const h5::Object info = h5::create_group(root, "info");
  write_text(info, "title", title);
  write_text(info, "description", description);
  write_text(info, "math_info", "");
}

void write_adhesion(const h5::Object& file, const AdhesionState& adhesion) {
  const h5::Object group = h5::create_group(file, "adhesion");
  h5::write_scalar_attribute(group, "time_step", adhesion.time_step);
  for (const fclib::AdhesionVector& vector : fclib::adhesion_vectors) {
    const std::vector<double>& values = adhesion.*vector.member;
    if (!values.empty()) write_reals(group, vector.name, values);
  }
}

/// FCLIB's reader of guesses requires velocities too; a start from impulses has none.
void write_guess(const h5::Object& file, const ContactProblem& problem) {
  const h5::Object guesses = h5::create_group(file, "guesses");
  write_integers(guesses, "number_of_guesses", {1});
  const h5::Object guess = h5::create_group(guesses, "1");
  std::vector<double> impulse = problem.impulse_guess;
  impulse.resize(3 * problem.friction.size(), 0.0);
  write_reals(guess, "r", impulse);
  write_reals(guess, "u", std::vector<double>(impulse.size()));
  const auto write_row_guess = [&](const char* name, const std::vector<double>& values) {
    if (!values.empty()) write_reals(guess, name, values);
  };
  write_row_guess("l", problem.bilateral.impulse_guess);
  write_row_guess("m", problem.rolling.impulse_guess);
  if (!problem.is_local()) write_reals(guess, "v", std::vector<double>(problem.load.size()));
}

/// Throws unless `values` is as long as the vector of the problem that it belongs to.
void check_length(const h5::Object& file,
                  const std::string& vector,
                  const std::string& name,
                  const std::vector<double>& values) {
  const h5::Dataset dataset = h5::open_dataset(file, vector);
  const std::int64_t expected = fclib::element_count(dataset);
  if (static_cast<std::int64_t>(values.size()) == expected) return;
  dataset.fail("holds " + std::to_string(expected) + " numbers, but " + name +
               " of the solution has " + std::to_string(values.size()) +
               ": the solution is of another problem");
}

void check_lengths(const std::string& problem, const ContactSolution& solution) {
  const h5::Object file = h5::open_file(problem);
  const bool is_local = h5::is_group(file, "fclib_local");
  const std::string offset = is_local ? "fclib_local/vectors/q" : "fclib_global/vectors/w";
  check_length(file, offset, "impulse", solution.impulse);
  check_length(file, offset, "velocity", solution.velocity);
  if (!is_local) {
    check_length(file, "fclib_global/vectors/f", "body_velocity", solution.body_velocity);
  }
  if (!solution.bilateral_impulse.empty()) {
    check_length(file, "fclib_global/vectors/b", "bilateral_impulse", solution.bilateral_impulse);
  }
}

/// Mode, as its number in ContactMode, and residual of each contact.
void write_modes(const h5::Object& group, const ContactModes& modes) {
  std::vector<std::int64_t> numbers;
  for (const ContactMode mode : modes.mode) numbers.push_back(static_cast<std::int64_t>(mode));
  write_integers(group, "contact_mode", numbers);
  write_reals(group, "contact_residual", modes.residual);
}

void write_solution(const h5::Object& file,
                    const ContactSolution& solution,
                    const ContactModes* modes) {
  const ContactReport& report = solution.report;
  const h5::Object group = h5::create_group(file, "solution");
  write_reals(group, "r", solution.impulse);
  write_reals(group, "u", solution.velocity);
  if (!solution.body_velocity.empty()) write_reals(group, "v", solution.body_velocity);
  if (!solution.bilateral_impulse.empty()) write_reals(group, "l", solution.bilateral_impulse);
  if (!solution.rolling_impulse.empty()) write_reals(group, "m", solution.rolling_impulse);
  write_reals(group, "residual_history", report.residual_history);
  h5::write_scalar_attribute(group, "converged", std::int64_t{solution.converged()});
  h5::write_text_attribute(group, "status", name_of(report.status));
  h5::write_scalar_attribute(group, "residual", report.residual.eta);
  h5::write_scalar_attribute(group, "fclib_error", report.residual.fclib);
  if (!report.method.empty()) h5::write_text_attribute(group, "method", report.method);
  if (modes != nullptr) write_modes(group, *modes);
}
}  // namespace

std::int64_t write_contact_problem(const std::string& path,
                                   const ContactProblem& problem,
                                   const std::string& title,
                                   const std::string& description) {
  const h5::Silence silence;
  try {
    check_problem(problem);
  } catch (const ContactProblemError& error) {
    throw IoError(path, fclib::path_of(error.field(), problem.is_local()), error.what());
  }
  h5::OutputFile output(path);
  {
    const h5::Object root =
        h5::create_group(output.file(), problem.is_local() ? "fclib_local" : "fclib_global");
    write_problem(root, problem);
    write_info(root, title, description);
    if (!problem.adhesion.empty()) write_adhesion(output.file(), problem.adhesion);
    if (!problem.block_start.empty()) {
      write_integers(h5::create_group(output.file(), "blocks"), "block_ptr",
                     {problem.block_start.begin(), problem.block_start.end()});
    }
    fclib::write_extensions(output.file(), problem);
    const bool has_guess = !problem.impulse_guess.empty() ||
                           !problem.bilateral.impulse_guess.empty() ||
                           !problem.rolling.impulse_guess.empty();
    if (has_guess) write_guess(output.file(), problem);
  }
  return output.finish();
}

std::int64_t write_contact_solution(const std::string& path,
                                    const std::string& problem_path,
                                    const ContactSolution& solution,
                                    const AdhesionStep* adhesion_next,
                                    const ContactModes* modes) {
  const h5::Silence silence;
  check_lengths(problem_path, solution);
  h5::OutputFile output(path, problem_path);
  output.remove("solution");
  output.remove("adhesion_next");
  write_solution(output.file(), solution, modes);
  if (adhesion_next != nullptr) {
    const h5::Object group = h5::create_group(output.file(), "adhesion_next");
    write_reals(group, "intensity", adhesion_next->intensity);
    write_reals(group, "gap", adhesion_next->gap);
  }
  return output.finish();
}

}  // namespace tetwarp
