/// @file fuzz_contact.hpp
/// Contact problems for the fuzzing of readers.
#pragma once
#include <array>
#include <string>
#include <tetwarp/io.hpp>

#include "tests/support/contact/contact_files.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {

constexpr std::array contact_seeds = {"local", "global", "solved", "triplets", "jointed"};

inline void write_contact_seeds(const ScratchFolder& folder) {
  write_contact_problem(folder / "local", local_problem(), "title", "description");
  write_contact_problem(folder / "global", adhesive_problem());
  write_contact_problem(folder / "jointed", jointed_problem());
  ContactSolution solution;
  solution.impulse = {1, 2, 3, 4, 5, 6};
  solution.velocity = solution.impulse;
  solution.body_velocity = solution.impulse;
  const AdhesionStep next{{0.5, 0.25}, {1, 2, 3, 4, 5, 6}, {0, 0}};
  write_contact_solution(folder / "solved", folder / "global", solution, &next);
  write_contact_problem(folder / "triplets", sliding_point());
  Hdf5Editor(folder / "triplets")
      .dataset<std::int32_t>("fclib_local/W/nz", {1}, {3})
      .dataset<std::int32_t>("fclib_local/W/p", {3}, {0, 1, 2});
}

/// Reads all of a contact file and writes a solution beside what it holds. Throws IoError.
inline void read_contact_file(const std::string& path, const std::string& copy) {
  read_contact_header(path);
  const ContactProblem problem = read_contact_problem(path);
  ContactSolution solution;
  solution.impulse.resize(3 * problem.friction.size());
  solution.velocity = solution.impulse;
  solution.body_velocity.resize(problem.load.size());
  write_contact_solution(copy, path, solution);
  read_contact_problem(path, ContactStart::stored);
}

}  // namespace tetwarp::test
