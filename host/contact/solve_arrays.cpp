/// @file solve_arrays.cpp
/// Solves of problems whose numbers are in arrays of the caller, in host memory or on a device.
#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "host/contact/fill_report.hpp"
#include "host/contact/solver_state.hpp"
#include "host/contact/structure/extract.hpp"

namespace tetwarp {
namespace {
/// Calls visit(name, given array, array of the problem, whether it may be left out).
template <class Visit>
void for_each_array(const ContactArrays& given, ContactProblem& problem, const Visit& visit) {
  AdhesionState& adhesion = problem.adhesion;
  visit("system", given.system, problem.system.value, false);
  visit("jacobian", given.jacobian, problem.jacobian.value, false);
  visit("load", given.load, problem.load, false);
  visit("velocity_offset", given.velocity_offset, problem.velocity_offset, false);
  visit("delassus", given.delassus, problem.delassus.value, false);
  visit("free_velocity", given.free_velocity, problem.free_velocity, false);
  visit("friction", given.friction, problem.friction, false);
  visit("area", given.area, adhesion.area, true);
  visit("stiffness", given.stiffness, adhesion.stiffness, true);
  visit("tangential_stiffness", given.tangential_stiffness, adhesion.tangential_stiffness, true);
  visit("intensity", given.intensity, adhesion.intensity, true);
  visit("gap", given.gap, adhesion.gap, true);
  visit("impulse_guess", given.impulse_guess, problem.impulse_guess, true);
}

[[noreturn]] void fail(const std::string& array, const std::string& what) {
  throw std::invalid_argument(array + ": " + what);
}

void check_size(const std::string& array, std::size_t size, std::size_t expected) {
  if (size == expected) return;
  fail(array, std::to_string(size) + " numbers, expected " + std::to_string(expected) +
                  ", as in the problem of set_structure()");
}

void check_sizes(const ContactArrays& given, ContactProblem& pattern, const ContactTarget& target) {
  const std::size_t contacts = pattern.friction.size();
  for_each_array(given, pattern,
                 [&](const std::string& name, auto array, const auto& known, bool is_optional) {
                   if (is_optional && array.empty()) return;
                   const bool is_of_rows = name == "gap" || name == "impulse_guess";
                   const std::size_t optional_size = is_of_rows ? 3 * contacts : contacts;
                   check_size(name, array.size(), is_optional ? optional_size : known.size());
                 });
  const auto check_target = [](const std::string& name, auto array, std::size_t size) {
    if (!array.empty()) check_size(name, array.size(), size);
  };
  check_target("impulse", target.impulse, 3 * contacts);
  check_target("velocity", target.velocity, 3 * contacts);
  check_target("body_velocity", target.body_velocity, pattern.load.size());
}

void check_memory(const ContactArrays& given,
                  ContactProblem& pattern,
                  const ContactTarget& target,
                  const ContactDevice* device) {
  if (given.memory != target.memory) fail("target", "its memory differs from that of the problem");
  if (given.memory == Memory::host) return;
  if (device == nullptr) fail("arrays", "device memory needs back end cuda");
  const auto check = [&](const std::string& name, const double* data, std::size_t size) {
    if (size > 0 && !device->is_device_memory(data)) {
      fail(name,
           "not in memory of the device of this solver; set memory to Memory::host, or "
           "allocate the array there");
    }
  };
  for_each_array(given, pattern, [&](const std::string& name, auto array, const auto&, bool) {
    check(name, array.data(), array.size());
  });
  check("impulse", target.impulse.data(), target.impulse.size());
  check("velocity", target.velocity.data(), target.velocity.size());
  check("body_velocity", target.body_velocity.data(), target.body_velocity.size());
}

ResidentProblem resident_problem(const ContactArrays& given,
                                 const ContactTarget& target,
                                 const ContactProblem& pattern) {
  const bool is_local = pattern.is_local();
  ResidentProblem problem;
  problem.pattern = &pattern;
  ContactInput& in = problem.input;
  in.matrix = view_of(is_local ? given.delassus : given.system);
  in.jacobian = view_of(given.jacobian);
  in.load = view_of(given.load);
  in.given_velocity = view_of(is_local ? given.free_velocity : given.velocity_offset);
  in.friction = view_of(given.friction);
  in.has_adhesion = !given.intensity.empty();
  in.time_step = given.time_step;
  in.area = view_of(given.area);
  in.stiffness = view_of(given.stiffness);
  in.tangential_stiffness = view_of(given.tangential_stiffness);
  in.intensity = view_of(given.intensity);
  in.gap = view_of(given.gap);
  problem.guess = view_of(given.impulse_guess);
  problem.impulse = view_of(target.impulse);
  problem.velocity = view_of(target.velocity);
  problem.body_velocity = view_of(target.body_velocity);
  problem.stream = target.stream;
  return problem;
}

/// Whether no island needs the host, as far as the structure says.
bool can_stay_on_device(const ContactStructure& structure) {
  return structure.contact_islands > 0 &&
         std::none_of(structure.islands.begin(), structure.islands.end(),
                      [](const ContactIsland& island) { return island.is_coupled; });
}

/// Counts of the structure, and indices of the problem in the outcomes.
void complete(const ContactStructure& structure, EngineResult& result) {
  for (std::size_t i = 0; i < structure.islands.size(); ++i) {
    const ContactIsland& island = structure.islands[i];
    if (i < result.outcomes.size()) {
      result.colors = std::max(result.colors, island.color_end - island.color_begin - 1);
      to_problem_index(structure, 0, result.outcomes[i].sums);
    } else {
      result.bodies_skipped += island.block_end - island.block_begin;
    }
  }
}

/// The report and status of a solve whose results never left the device.
/// @param found  its outcomes are moved from
void set_report(const ContactStructure& structure,
                const ContactOptions& options,
                const SolveBudget& budget,
                DeviceRun& found,
                ContactSolution& solution) {
  EngineResult result;
  result.outcomes = std::move(found.outcomes);
  result.savings = found.end.savings;
  result.updates_skipped = found.end.updates_skipped;
  complete(structure, result);
  const WholeResidual whole = whole_residual(result.outcomes);
  fill_report(result, whole, options.measure, solution.report);
  solution.report.residual.balance = found.end.balance;
  set_status(result, whole, options, budget, solution);
}
}  // namespace

void ContactSolver::set_structure(const ContactProblem& problem) {
  if (!problem.second_friction.empty() || !problem.bilateral.empty() || !problem.rolling.empty() ||
      !problem.expert.row_blocks.empty()) {
    throw std::invalid_argument(
        "set_structure: the problem has second_friction, bilateral rows or rolling friction; solve "
        "such problems by solve(ContactProblem)");
  }
  check_problem(problem);
  State& s = *state_;
  s.engine.set_structure(problem);
  s.pattern_serial = s.engine.structure().serial;
  s.pattern = std::make_unique<ContactProblem>(problem);
}

ContactReport ContactSolver::solve(const ContactArrays& arrays, const ContactTarget& target) {
  State& s = *state_;
  const auto start = std::chrono::steady_clock::now();
  if (s.pattern == nullptr) {
    throw std::invalid_argument("solve: call set_structure() before the first solve of arrays");
  }
  ContactProblem& pattern = *s.pattern;
  check_sizes(arrays, pattern, target);
  check_memory(arrays, pattern, target, s.device.get());
  if (s.engine.structure().serial != s.pattern_serial) {
    s.engine.set_structure(pattern);
    s.pattern_serial = s.engine.structure().serial;
  }
  const bool is_on_device = arrays.memory == Memory::device;
  const ContactStructure& structure = s.engine.structure();
  SolveBudget budget(s.options, pattern);
  DeviceRun found;
  if (is_on_device && can_stay_on_device(structure)) {
    found.outcomes.resize(index_of(structure.contact_islands));
    s.device->budget = &budget;
    budget.is_over();
    found.end = s.device->solve_resident(s.options, structure,
                                         resident_problem(arrays, target, pattern), found.outcomes);
    if (found.end.is_solved) {
      budget.rethrow();
      ContactSolution solution;
      s.describe(pattern, solution.report);
      set_report(structure, s.options, budget, found, solution);
      solution.report.total_seconds = solution.report.solve_seconds = seconds_since(start);
      return solution.report;
    }
  }
  for_each_array(arrays, pattern, [&](const auto&, auto given, auto& own, bool) {
    own.resize(given.size());
    if (is_on_device && !given.empty()) {
      s.device->read(given.data(), static_cast<std::int64_t>(given.size()), own.data(),
                     target.stream);
    } else {
      std::copy(given.begin(), given.end(), own.begin());
    }
  });
  pattern.adhesion.time_step = arrays.time_step;
  const ContactSolution solution =
      s.backend == Backend::reference
          ? solve(pattern)
          : s.solve(pattern, budget, found.end.has_run ? &found : nullptr);
  s.pattern_serial = s.engine.structure().serial;
  const auto put = [&](const std::vector<double>& from, std::span<double> to) {
    if (to.empty()) return;
    if (is_on_device) {
      s.device->write(from.data(), static_cast<std::int64_t>(from.size()), to.data(),
                      target.stream);
    } else {
      std::copy(from.begin(), from.end(), to.begin());
    }
  };
  put(solution.impulse, target.impulse);
  put(solution.velocity, target.velocity);
  put(solution.body_velocity, target.body_velocity);
  return solution.report;
}

}  // namespace tetwarp
